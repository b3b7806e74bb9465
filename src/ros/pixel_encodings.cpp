#include "ros/pixel_encodings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "core/mat.h"
#include "core/text.h"
#include "diminish/error.h"
#include "source/image_file.h"
#include "source/image_header.h"

namespace diminish::ros {
namespace {

constexpr std::uint32_t most_side = 16384;
constexpr std::uint64_t most_pixels = 1 << 26;

/// How an encoding becomes BGR. OpenCV names Bayer patterns by the second row's second and third
/// pixel, ROS by the first two rows' first two.
struct ColorEncoding {
  const char* name;
  int mat_type;
  int conversion;  ///< none: it is BGR already
};
constexpr int none = -1;
constexpr std::array color_encodings = {
    ColorEncoding{"bgr8", CV_8UC3, none},
    ColorEncoding{"8UC3", CV_8UC3, none},
    ColorEncoding{"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
    ColorEncoding{"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR},
    ColorEncoding{"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR},
    ColorEncoding{"mono8", CV_8UC1, cv::COLOR_GRAY2BGR},
    ColorEncoding{"8UC1", CV_8UC1, cv::COLOR_GRAY2BGR},
    ColorEncoding{"yuv422", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
    ColorEncoding{"uyvy", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
    ColorEncoding{"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUYV},
    ColorEncoding{"yuyv", CV_8UC2, cv::COLOR_YUV2BGR_YUYV},
    ColorEncoding{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2BGR},
    ColorEncoding{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2BGR},
    ColorEncoding{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2BGR},
    ColorEncoding{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2BGR},
};

std::string known_encodings() {
  std::vector<std::string> names;
  names.reserve(std::size(color_encodings));
  for (const ColorEncoding& encoding : color_encodings) names.emplace_back(encoding.name);
  return join(names);
}

/// Throws Error if the message's rows are not there.
void expect_rows(const ImageMessage& message, std::size_t pixel_bytes) {
  expect_camera_size(message.width, message.height);
  const std::size_t row = message.width * pixel_bytes;
  const std::size_t all = std::size_t{message.step} * (message.height - 1) + row;
  if (message.step < row || message.data.size() < all) {
    throw Error(Error::input, fmt::format("expected {} bytes of {} for {}x{} with rows of {}, "
                                          "got {}",
                                          all, printable(message.encoding), message.width,
                                          message.height, message.step, message.data.size()));
  }
}

const std::uint8_t* row_of(const ImageMessage& message, int y) {
  return message.data.data() + static_cast<std::size_t>(y) * message.step;
}

template <class Pixel>
ImageMessage message_of(const Image<Pixel>& image, const char* encoding) {
  ImageMessage message;
  message.width = static_cast<std::uint32_t>(image.width());
  message.height = static_cast<std::uint32_t>(image.height());
  message.encoding = encoding;
  message.is_big_endian = std::endian::native == std::endian::big;
  message.step = message.width * sizeof(Pixel);
  message.data = {reinterpret_cast<const std::uint8_t*>(image.data()),
                  image.size() * sizeof(Pixel)};
  return message;
}

}  // namespace

void expect_camera_size(std::uint32_t width, std::uint32_t height) {
  if (width >= 1 && height >= 1 && width <= most_side && height <= most_side &&
      std::uint64_t{width} * height <= most_pixels) {
    return;
  }
  throw Error(Error::input, fmt::format("expected an image of at most {} million pixels, got {}x{}",
                                        most_pixels / 1'000'000, width, height));
}

void expect_declared_size(std::span<const std::uint8_t> image) {
  const auto size = declared_size(image);
  if (!size) throw Error(Error::input, "expected a compressed image: JPEG or PNG");
  expect_camera_size(static_cast<std::uint32_t>(size->width),
                     static_cast<std::uint32_t>(size->height));
}

bool is_depth_encoding(const std::string& encoding) {
  return encoding == "16UC1" || encoding == "mono16" || encoding == "32FC1";
}

void rescale_depth(double from_unit_m, double to_unit_m, Image<std::uint16_t>& depth) {
  if (from_unit_m == to_unit_m) return;
  for (std::uint16_t& value : depth) {
    value = depth_value(static_cast<float>(value * from_unit_m), static_cast<float>(to_unit_m));
  }
}

void read_color(const ImageMessage& message, Image<Bgr>& color) {
  const auto encoding =
      std::find_if(color_encodings.begin(), color_encodings.end(),
                   [&](const ColorEncoding& known) { return message.encoding == known.name; });
  if (encoding == color_encodings.end()) {
    throw Error(Error::input, fmt::format("expected a colour image as one of {}, got '{}'",
                                          known_encodings(), printable(message.encoding)));
  }
  expect_rows(message, CV_ELEM_SIZE(encoding->mat_type));
  const int width = static_cast<int>(message.width);
  const int height = static_cast<int>(message.height);
  const bool is_halved = encoding->mat_type == CV_8UC2;  // two pixels share their colour
  if (is_halved && width % 2 != 0) {
    throw Error(Error::input,
                fmt::format("expected an even width of {}, got {}", encoding->name, width));
  }
  color.resize(width, height);
  if (encoding->conversion == none) {
    for (int y = 0; y < height; ++y) {
      std::memcpy(color.row(y), row_of(message, y), message.width * sizeof(Bgr));
    }
    return;
  }
  // OpenCV has no header for what is only read.
  const cv::Mat pixels(height, width, encoding->mat_type,
                       const_cast<std::uint8_t*>(message.data.data()), message.step);
  cv::Mat target = as_mat(color);
  cv::cvtColor(pixels, target, encoding->conversion);
}

void read_color(const CompressedImageMessage& message, Image<Bgr>& color) {
  expect_declared_size(message.data);
  copy_from(decode<Bgr>({message.data.begin(), message.data.end()}), color);
}

void read_depth(const ImageMessage& message, double unit_m, Image<std::uint16_t>& depth) {
  if (!is_depth_encoding(message.encoding)) {
    throw Error(Error::input, fmt::format("expected a depth image as 16UC1 or 32FC1, got '{}'",
                                          printable(message.encoding)));
  }
  const bool is_float = message.encoding == "32FC1";
  expect_rows(message, is_float ? sizeof(float) : sizeof(std::uint16_t));
  const bool is_swapped = message.is_big_endian != (std::endian::native == std::endian::big);
  depth.resize(static_cast<int>(message.width), static_cast<int>(message.height));
  for (int y = 0; y < depth.height(); ++y) {
    const std::uint8_t* from = row_of(message, y);
    std::uint16_t* const to = depth.row(y);
    if (!is_float) {
      std::memcpy(to, from, message.width * sizeof(std::uint16_t));
      if (!is_swapped) continue;
      for (int x = 0; x < depth.width(); ++x) {
        to[x] = static_cast<std::uint16_t>(to[x] << 8 | to[x] >> 8);
      }
      continue;
    }
    for (int x = 0; x < depth.width(); ++x, from += sizeof(float)) {
      std::array<std::uint8_t, sizeof(float)> raw;
      std::memcpy(raw.data(), from, sizeof(float));
      if (is_swapped) std::reverse(raw.begin(), raw.end());
      to[x] = depth_value(std::bit_cast<float>(raw), static_cast<float>(unit_m));
    }
  }
  if (!is_float) rescale_depth(millimetre_m, unit_m, depth);
}

Image<float> depth_in_metres(const Image<std::uint16_t>& depth, double unit_m) {
  Image<float> metres(depth.width(), depth.height());
  std::transform(depth.begin(), depth.end(), metres.begin(),
                 [&](std::uint16_t value) { return static_cast<float>(value * unit_m); });
  return metres;
}

ImageMessage image_message(const Image<Bgr>& image) {
  return message_of(image, "bgr8");
}
ImageMessage image_message(const Image<std::uint16_t>& image) {
  return message_of(image, "16UC1");
}
ImageMessage image_message(const Image<float>& image) {
  return message_of(image, "32FC1");
}
ImageMessage image_message(const Image<std::uint8_t>& image) {
  return message_of(image, "mono8");
}

}  // namespace diminish::ros
