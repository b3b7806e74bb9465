#include "remote/layer_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
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
/// Other than 0. Less would not be a distance or a size any more.
constexpr float least_exact = 1e-6F;

std::uint8_t level(int value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
}

/// Seven bits a byte, the lowest first; all but a number's last byte are marked.
void append_number(std::uint32_t number, std::vector<std::uint8_t>& bytes) {
  for (; number >= 128; number >>= 7) bytes.push_back(static_cast<std::uint8_t>(number | 128));
  bytes.push_back(static_cast<std::uint8_t>(number));
}

class NumberReader {
 public:
  explicit NumberReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool is_at_end() const { return rest_.empty(); }
  std::uint32_t number() {
    std::uint32_t number = 0;
    for (int shift = 0;; shift += 7) {
      if (rest_.empty() || shift > 28) throw Error(Error::input, "expected a whole number");
      const std::uint8_t byte = rest_.front();
      rest_ = rest_.subspan(1);
      number |= static_cast<std::uint32_t>(byte & 127) << shift;
      if (byte < 128) return number;
    }
  }
  /// A number of pixels.
  std::size_t length(std::size_t most) {
    const std::uint32_t length = number();
    if (length > most) throw Error(Error::input, "expected no more pixels than the image has");
    return length;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// What a word is likely to be: as far from its left neighbour as the upper one is from its own.
/// Neighbours that are 0 tell nothing. Modulo 2^32.
std::uint32_t expected_word(const Image<std::uint32_t>& words, std::size_t at, std::uint32_t last) {
  const auto width = static_cast<std::size_t>(words.width());
  const std::uint32_t* const here = words.data() + at;
  const std::uint32_t left = at % width > 0 ? here[-1] : 0;
  const std::uint32_t upper = at >= width ? *(here - width) : 0;
  if (left == 0) return upper != 0 ? upper : last;
  const std::uint32_t corner = at >= width ? *(here - width - 1) : 0;
  return upper != 0 && corner != 0 ? left + upper - corner : left;
}

}  // namespace

void compress_color(const Image<Bgr>& color, const Image<float>& inverse_z,
                    std::vector<std::uint8_t>& bytes) {
  const int height = color.height();
  Image<std::uint16_t> all(color.width(), planes * height);
  for (int y = 0; y < height; ++y) {
    const float* const there = inverse_z.row(y);
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

void decompress_color(std::span<const std::uint8_t> bytes, const Image<float>& inverse_z,
                      Image<Bgr>& color) {
  const int height = color.height();
  Image<std::uint16_t> all(color.width(), planes * height);
  ros::decompress_depth(bytes, all);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < color.width(); ++x) {
      if (inverse_z(x, y) == 0) continue;
      const int green = all(x, y) - 1;
      color(x, y) = {level(all(x, height + y) - middle + green), level(green),
                     level(all(x, 2 * height + y) - middle + green)};
    }
  }
}

void compress_jpeg(Image<Bgr>& color, const Image<float>& inverse_z, int quality,
                   std::vector<std::uint8_t>& bytes) {
  Bgr last{128, 128, 128};
  for (int y = 0; y < color.height(); ++y) {
    for (int x = 0; x < color.width(); ++x) {
      Bgr& c = color(x, y);
      if (inverse_z(x, y) == 0) {
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

void compress_words(const Image<std::uint32_t>& words, std::vector<std::uint8_t>& bytes) {
  const std::uint32_t* const data = words.data();
  std::uint32_t last = 0;
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t begin = at;
    while (at < words.size() && data[at] == 0) ++at;
    append_number(static_cast<std::uint32_t>(at - begin), bytes);
    std::size_t end = at;
    while (end < words.size() && data[end] != 0) ++end;
    append_number(static_cast<std::uint32_t>(end - at), bytes);
    for (; at < end; ++at) {
      const auto off = static_cast<std::int32_t>(data[at] - expected_word(words, at, last));
      append_number(static_cast<std::uint32_t>(off) << 1 ^ static_cast<std::uint32_t>(off >> 31),
                    bytes);
      last = data[at];
    }
  }
}

void decompress_words(std::span<const std::uint8_t> bytes, Image<std::uint32_t>& words) {
  NumberReader reader(bytes);
  std::uint32_t last = 0;
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t gap = reader.length(words.size() - at);
    std::fill_n(words.data() + at, gap, 0U);
    at += gap;
    const std::size_t count = reader.length(words.size() - at);
    if (gap == 0 && count == 0) throw Error(Error::input, "expected runs of some pixels");
    for (const std::size_t end = at + count; at < end; ++at) {
      const std::uint32_t off = reader.number();
      last = expected_word(words, at, last) + (off >> 1 ^ (0U - (off & 1)));
      words.data()[at] = last;
    }
  }
  if (!reader.is_at_end()) throw Error(Error::input, "expected nothing after the last pixel");
}

void compress_exactly(const Image<float>& values, std::vector<std::uint8_t>& bytes) {
  Image<std::uint32_t> words(values.width(), values.height());
  std::transform(values.begin(), values.end(), words.begin(),
                 [](float value) { return std::bit_cast<std::uint32_t>(value); });
  compress_words(words, bytes);
}

void decompress_exactly(std::span<const std::uint8_t> bytes, float most, Image<float>& values) {
  Image<std::uint32_t> words(values.width(), values.height());
  decompress_words(bytes, words);
  std::transform(words.begin(), words.end(), values.begin(),
                 [](std::uint32_t word) { return std::bit_cast<float>(word); });
  expect_numbers(values, most);
}

void expect_numbers(const Image<float>& values, float most) {
  const bool are_there = std::all_of(values.begin(), values.end(), [&](float value) {
    return std::bit_cast<std::uint32_t>(value) == 0 || (value >= least_exact && value <= most);
  });
  if (!are_there) throw Error(Error::input, "expected numbers within their range");
}

double compress_inverse_z(const Image<float>& inverse_z, double unit_m,
                          std::vector<std::uint8_t>& bytes) {
  constexpr float most_steps = std::numeric_limits<std::uint16_t>::max();
  float least = std::numeric_limits<float>::infinity();
  for (const float value : inverse_z) least = value > 0 ? std::min(least, value) : least;
  const double step_m = std::max(unit_m, static_cast<double>(1 / least / (most_steps - 1)));
  const auto steps_a_m = static_cast<float>(1 / step_m);
  Image<std::uint16_t> depth(inverse_z.width(), inverse_z.height());
  std::transform(inverse_z.begin(), inverse_z.end(), depth.begin(), [&](float value) {
    const float steps = value > 0 ? std::clamp(steps_a_m / value + 0.5F, 1.F, most_steps) : 0;
    return static_cast<std::uint16_t>(steps);
  });
  ros::compress_depth(depth, bytes);
  return step_m;
}

void decompress_inverse_z(std::span<const std::uint8_t> bytes, double unit_m,
                          Image<float>& inverse_z) {
  Image<std::uint16_t> depth(inverse_z.width(), inverse_z.height());
  ros::decompress_depth(bytes, depth);
  const auto unit = static_cast<float>(unit_m);
  std::transform(depth.begin(), depth.end(), inverse_z.begin(), [&](std::uint16_t steps) {
    return steps == 0 ? 0.F : 1 / (static_cast<float>(steps) * unit);
  });
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
  // Rows follow one another without gaps.
  int end = 0;
  for_each_run(mask.data(), 0, static_cast<int>(mask.size()), Pixels::set,
               [&](int first, int last) {
                 append_number(static_cast<std::uint32_t>(first - end), bytes);
                 append_number(static_cast<std::uint32_t>(last - first), bytes);
                 end = last;
               });
}

void decompress_mask(std::span<const std::uint8_t> bytes, Mask& mask) {
  mask.fill(0);
  NumberReader reader(bytes);
  std::size_t at = 0;
  while (!reader.is_at_end()) {
    at += reader.length(mask.size() - at);
    const std::size_t length = reader.length(mask.size() - at);
    std::fill_n(mask.data() + at, length, std::uint8_t{255});
    at += length;
  }
}

}  // namespace diminish
