#include "source/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <system_error>

#include "core/mat.h"
#include "diminish/error.h"
#include "source/image_header.h"

namespace diminish {
namespace {

/// Whether a JPEG ends before its end-of-image marker: decoders fill up what is missing with grey
/// and say nothing. Neither marker can occur inside of coded pixels.
bool is_cut_short(const std::vector<std::uint8_t>& bytes) {
  constexpr std::array<std::uint8_t, 2> image_start = {0xff, 0xd8};
  constexpr std::array<std::uint8_t, 2> scan_start = {0xff, 0xda};
  constexpr std::array<std::uint8_t, 2> image_end = {0xff, 0xd9};
  const auto last = [&](const std::array<std::uint8_t, 2>& marker) {
    return std::find_end(bytes.begin(), bytes.end(), marker.begin(), marker.end());
  };
  const bool is_jpeg =
      bytes.size() > 2 && std::equal(image_start.begin(), image_start.end(), bytes.begin());
  return is_jpeg && (last(image_end) == bytes.end() || last(image_end) < last(scan_start));
}

/// More than any camera has.
constexpr std::int64_t most_pixels = 1 << 28;

std::int64_t pixels_of(const cv::Size& size) {
  return static_cast<std::int64_t>(size.width) * size.height;
}

cv::Mat decode_with(const std::vector<std::uint8_t>& bytes, int flags) {
  if (bytes.empty()) throw Error(Error::input, "the file is empty");
  if (is_cut_short(bytes)) throw Error(Error::input, "the file is cut short");
  if (const auto size = declared_size(bytes); size && pixels_of(*size) > most_pixels) {
    throw Error(Error::input, fmt::format("expected at most {} million pixels, got {}x{}",
                                          most_pixels / 1'000'000, size->width, size->height));
  }
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, flags);
  } catch (const cv::Exception&) {
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
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  stream.seekg(0);
  if (size > 0 && !stream.read(reinterpret_cast<char*>(bytes.data()), size)) {
    throw Error(Error::io, "cannot be read");
  }
  return bytes;
}

template <>
cv::Mat decode<Bgr>(const std::vector<std::uint8_t>& bytes) {
  return decode_with(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

template <>
cv::Mat decode<std::uint16_t>(const std::vector<std::uint8_t>& bytes) {
  return decode_with(bytes, cv::IMREAD_UNCHANGED);
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
  const cv::Mat image = decode_with(read_bytes(file), cv::IMREAD_UNCHANGED);
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
