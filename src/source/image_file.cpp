#include "source/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <system_error>

#include "core/mat.h"
#include "diminish/error.h"
#include "source/image_damage.h"
#include "source/image_header.h"
#include "source/jpeg_decoder.h"

namespace diminish {
namespace {

/// More than any camera has.
constexpr std::int64_t most_pixels = 1 << 28;
constexpr std::streamoff most_bytes = 2'000'000'000;

std::int64_t pixels_of(const cv::Size& size) {
  return static_cast<std::int64_t>(size.width) * size.height;
}

[[noreturn]] void fail_for_memory() {
  throw Error(Error::input, "there is not enough memory for it");
}

/// Throws Error.
void check(const std::vector<std::uint8_t>& bytes) {
  if (bytes.empty()) throw Error(Error::input, "the file is empty");
  const auto size = declared_size(bytes);
  if (!size)
    throw Error(Error::input, "cannot be decoded, expected PNG, JPEG, BMP, TIFF, WebP, PGM or PPM");
  if (pixels_of(*size) > most_pixels) {
    throw Error(Error::input, fmt::format("expected at most {} million pixels, got {}x{}",
                                          most_pixels / 1'000'000, size->width, size->height));
  }
  if (const char* const damage = damage_of(bytes)) throw Error(Error::input, damage);
}

cv::Mat decode_checked(const std::vector<std::uint8_t>& bytes, int flags) {
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, flags);
  } catch (const std::bad_alloc&) {
    fail_for_memory();
  } catch (const cv::Exception& error) {
    if (error.code == cv::Error::StsNoMem) fail_for_memory();
  }
  if (image.empty()) throw Error(Error::input, "cannot be decoded");
  return image;
}

std::string size_text(const cv::Mat& image) {
  return fmt::format("{}x{}", image.cols, image.rows);
}

std::string format_text(const cv::Mat& image) {
  const std::string channels =
      image.channels() == 1 ? "one-channel" : fmt::format("{}-channel", image.channels());
  return fmt::format("{}-bit {} {}", 8 * image.elemSize1(), channels, size_text(image));
}

}  // namespace

std::vector<std::uint8_t> read_bytes(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw Error(Error::input, "there is no such file");
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();
  if (!stream || size < 0) throw Error(Error::io, "cannot be opened");
  if (size > most_bytes) throw Error(Error::input, "expected an image of at most 2 GB");
  std::vector<std::uint8_t> bytes;
  try {
    bytes.resize(static_cast<std::size_t>(size));
  } catch (const std::bad_alloc&) {
    fail_for_memory();
  }
  stream.seekg(0);
  if (size > 0 && !stream.read(reinterpret_cast<char*>(bytes.data()), size)) {
    throw Error(Error::io, "cannot be read");
  }
  return bytes;
}

template <>
cv::Mat decode<Bgr>(const std::vector<std::uint8_t>& bytes) {
  check(bytes);
  if (is_jpeg(bytes)) {
    try {
      if (cv::Mat image = decode_jpeg(bytes); !image.empty()) return image;
    } catch (const cv::Exception&) {  // its pixels cannot be allocated
      fail_for_memory();
    }
  }
  return decode_checked(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

template <>
cv::Mat decode<std::uint16_t>(const std::vector<std::uint8_t>& bytes) {
  check(bytes);
  return decode_checked(bytes, cv::IMREAD_UNCHANGED);
}

template <>
void expect_format<Bgr>(const cv::Mat& image, const Intrinsics& camera) {
  if (image.cols == camera.width && image.rows == camera.height && image.type() == CV_8UC3) return;
  throw Error(Error::input,
              fmt::format("expected {}x{}, got {}", camera.width, camera.height, size_text(image)));
}

template <>
void expect_format<std::uint16_t>(const cv::Mat& image, const Intrinsics& camera) {
  if (image.cols == camera.width && image.rows == camera.height && image.type() == CV_16UC1) return;
  throw Error(Error::input, fmt::format("expected 16-bit one-channel {}x{}, got {}", camera.width,
                                        camera.height, format_text(image)));
}

void read_mask(const std::filesystem::path& file, const Intrinsics& camera, Mask& mask) {
  const cv::Mat image = decode<std::uint16_t>(read_bytes(file));
  if (image.cols != camera.width || image.rows != camera.height) {
    throw Error(Error::input, fmt::format("expected {}x{}, got {}", camera.width, camera.height,
                                          size_text(image)));
  }
  mask.resize(camera.width, camera.height, 0);
  cv::Mat target = as_mat(mask);
  cv::Mat channel;
  for (int i = 0; i < std::min(image.channels(), 3); ++i) {
    cv::extractChannel(image, channel, i);
    target |= channel != 0;
  }
}

}  // namespace diminish
