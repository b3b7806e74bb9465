#include "detect/color_blob/extremum_filters.h"

namespace diminish {
namespace {

constexpr auto larger = [](std::uint8_t a, std::uint8_t b) { return a > b ? a : b; };
constexpr auto smaller = [](std::uint8_t a, std::uint8_t b) { return a < b ? a : b; };

/// result[i] = choose(result[i], other[i]); the two must not overlap.
template <class Choose>
void combine(const std::uint8_t* __restrict other, std::ptrdiff_t count, const Choose& choose,
             std::uint8_t* __restrict result) {
  for (std::ptrdiff_t i = 0; i < count; ++i) result[i] = choose(result[i], other[i]);
}

/// Combines `result` with `values` shifted by up to `reach` times `step` bytes to both sides.
template <class Choose>
void combine_moved(const std::uint8_t* values, std::ptrdiff_t count, std::ptrdiff_t step, int reach,
                   const Choose& choose, std::uint8_t* result) {
  for (int i = 1; i <= reach && i * step < count; ++i) {
    combine(values + i * step, count - i * step, choose, result);
    combine(values, count - i * step, choose, result + i * step);
  }
}

/// Columns [first, last) of a row, one value at a time.
template <class Choose>
void filter_columns(const std::uint8_t* row, int width, int channels, int reach, int first,
                    int last, const Choose& choose, std::uint8_t* result) {
  for (int x = first; x < last; ++x) {
    for (int channel = 0; channel < channels; ++channel) {
      std::uint8_t value = row[x * channels + channel];
      for (int other = std::max(x - reach, 0); other <= std::min(x + reach, width - 1); ++other) {
        value = choose(value, row[other * channels + channel]);
      }
      result[x * channels + channel] = value;
    }
  }
}

template <class Pixel, class Choose>
void filter(const Image<Pixel>& image, const Reach& reach, const Choose& choose,
            Image<Pixel>& scratch, Image<Pixel>& result) {
  constexpr int channels = sizeof(Pixel);
  const int width = image.width();
  const std::ptrdiff_t pitch = std::ptrdiff_t{channels} * width;
  const std::ptrdiff_t count = pitch * image.height();
  scratch.resize(width, image.height());
  result.resize(width, image.height());
  const auto* const values = reinterpret_cast<const std::uint8_t*>(image.data());
  auto* const columns = reinterpret_cast<std::uint8_t*>(scratch.data());
  auto* const both = reinterpret_cast<std::uint8_t*>(result.data());
  // The whole image at once, because rows may be short.
  std::copy_n(values, count, columns);
  combine_moved(values, count, pitch, reach.y, choose, columns);
  std::copy_n(columns, count, both);
  if (reach.x == 0) return;
  combine_moved(columns, count, channels, reach.x, choose, both);
  // That ran on from each row's end into the next row.
  for (int y = 0; y < image.height(); ++y) {
    const std::uint8_t* const row = columns + y * pitch;
    const int left_end = std::min(reach.x, width);
    const int right = std::max(width - reach.x, left_end);
    filter_columns(row, width, channels, reach.x, 0, left_end, choose, both + y * pitch);
    filter_columns(row, width, channels, reach.x, right, width, choose, both + y * pitch);
  }
}

}  // namespace

void dilate(const Mask& image, const Reach& reach, Mask& scratch, Mask& result) {
  filter(image, reach, larger, scratch, result);
}
void erode(const Mask& image, const Reach& reach, Mask& scratch, Mask& result) {
  filter(image, reach, smaller, scratch, result);
}
void dilate(const Image<Bgr>& image, const Reach& reach, Image<Bgr>& scratch, Image<Bgr>& result) {
  filter(image, reach, larger, scratch, result);
}
void erode(const Image<Bgr>& image, const Reach& reach, Image<Bgr>& scratch, Image<Bgr>& result) {
  filter(image, reach, smaller, scratch, result);
}

}  // namespace diminish
