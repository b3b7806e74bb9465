#include "remote/layer_codec.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "blend/confidence_grid.h"
#include "core/mat.h"
#include "core/runs.h"
#include "diminish/error.h"
#include "ros/depth_codec.h"
#include "ros/pixel_encodings.h"
#include "source/jpeg_decoder.h"

namespace diminish {
namespace {

constexpr int planes = 3;
/// Added to differences of levels, so that none is 0: that is a gap.
constexpr int middle = 256;
constexpr float resolution_steps = 4096;

std::uint8_t level(int value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
}

}  // namespace

void compress_color(const Image<Bgr>& color, const Image<std::uint16_t>& depth,
                    std::vector<std::uint8_t>& bytes) {
  const int height = color.height();
  Image<std::uint16_t> all(color.width(), planes * height);
  for (int y = 0; y < height; ++y) {
    const std::uint16_t* const there = depth.row(y);
    std::uint16_t* const green = all.row(y);
    std::uint16_t* const blue = all.row(height + y);
    std::uint16_t* const red = all.row(2 * height + y);
    for (int x = 0; x < color.width(); ++x) {
      if (there[x] == 0) continue;
      const Bgr& c = color(x, y);
      green[x] = static_cast<std::uint16_t>(1 + c.g);
      blue[x] = static_cast<std::uint16_t>(middle + c.b - c.g);
      red[x] = static_cast<std::uint16_t>(middle + c.r - c.g);
    }
  }
  ros::compress_depth(all, bytes);
}

void decompress_color(std::span<const std::uint8_t> bytes, const Image<std::uint16_t>& depth,
                      Image<Bgr>& color) {
  const int height = color.height();
  Image<std::uint16_t> all(color.width(), planes * height);
  ros::decompress_depth(bytes, all);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < color.width(); ++x) {
      if (depth(x, y) == 0) continue;
      const int green = all(x, y) - 1;
      color(x, y) = {level(all(x, height + y) - middle + green), level(green),
                     level(all(x, 2 * height + y) - middle + green)};
    }
  }
}

void compress_jpeg(Image<Bgr>& color, const Image<std::uint16_t>& depth, int quality,
                   std::vector<std::uint8_t>& bytes) {
  Bgr last{128, 128, 128};
  for (int y = 0; y < color.height(); ++y) {
    for (int x = 0; x < color.width(); ++x) {
      Bgr& c = color(x, y);
      if (depth(x, y) == 0) {
        c = last;
      } else {
        last = c;
      }
    }
  }
  std::vector<std::uint8_t> made;
  cv::imencode(".jpg", as_mat(color), made, {cv::IMWRITE_JPEG_QUALITY, quality});
  bytes.insert(bytes.end(), made.begin(), made.end());
}

void decompress_jpeg(std::span<const std::uint8_t> bytes, Image<Bgr>& color) {
  ros::expect_declared_size(bytes);
  const cv::Mat decoded = decode_jpeg(bytes);
  if (decoded.cols != color.width() || decoded.rows != color.height()) {
    throw Error(Error::input, "a layer's JPEG is not of the layer's size");
  }
  for (int y = 0; y < color.height(); ++y) {
    std::copy_n(decoded.ptr<Bgr>(y), color.width(), color.row(y));
  }
}

void compress_resolution(const Image<float>& resolution, std::vector<std::uint8_t>& bytes) {
  Image<std::uint16_t> steps(resolution.width(), resolution.height());
  std::transform(resolution.begin(), resolution.end(), steps.begin(), [](float value) {
    if (!(value > 0)) return std::uint16_t{0};
    const float most = std::min(value, ConfidenceGrid::most_resolution);
    return static_cast<std::uint16_t>(std::max(1L, std::lround(most * resolution_steps)));
  });
  ros::compress_depth(steps, bytes);
}

void decompress_resolution(std::span<const std::uint8_t> bytes, Image<float>& resolution) {
  Image<std::uint16_t> steps(resolution.width(), resolution.height());
  ros::decompress_depth(bytes, steps);
  std::transform(steps.begin(), steps.end(), resolution.begin(),
                 [](std::uint16_t value) { return static_cast<float>(value) / resolution_steps; });
}

void compress_mask(const Mask& mask, std::vector<std::uint8_t>& bytes) {
  const auto write = [&](std::size_t length) {
    for (; length >= 128; length >>= 7) bytes.push_back(static_cast<std::uint8_t>(length | 128));
    bytes.push_back(static_cast<std::uint8_t>(length));
  };
  // Rows follow one another without gaps.
  int end = 0;
  for_each_run(mask.data(), 0, static_cast<int>(mask.size()), Pixels::set,
               [&](int first, int last) {
                 write(static_cast<std::size_t>(first - end));
                 write(static_cast<std::size_t>(last - first));
                 end = last;
               });
}

void decompress_mask(std::span<const std::uint8_t> bytes, Mask& mask) {
  mask.fill(0);
  std::size_t at = 0;
  std::size_t next = 0;
  const auto read = [&] {
    std::size_t length = 0;
    for (int shift = 0;; shift += 7) {
      if (next == bytes.size() || shift > 28) {
        throw Error(Error::input, "a mask ends within a number");
      }
      const std::uint8_t byte = bytes[next++];
      length |= static_cast<std::size_t>(byte & 127) << shift;
      if (byte < 128) break;
    }
    if (length > mask.size() - at) {
      throw Error(Error::input, "a mask has more pixels than its image");
    }
    return length;
  };
  while (next < bytes.size()) {
    at += read();
    const std::size_t length = read();
    std::fill_n(mask.data() + at, length, std::uint8_t{255});
    at += length;
  }
}

}  // namespace diminish
