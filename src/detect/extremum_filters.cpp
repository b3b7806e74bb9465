#include "detect/extremum_filters.h"

namespace diminish {
namespace {

constexpr auto larger = [](std::uint8_t a, std::uint8_t b) { return a > b ? a : b; };
constexpr auto smaller = [](std::uint8_t a, std::uint8_t b) { return a < b ? a : b; };

/// result[i] = choose(result[i], other[i]); the rows must not overlap.
template <class Choose>
void combine(const std::uint8_t* __restrict other, int count, const Choose& choose,
             std::uint8_t* __restrict result) {
  for (int i = 0; i < count; ++i) result[i] = choose(result[i], other[i]);
}

template <class Pixel, class Choose>
void filter(const Image<Pixel>& image, const Reach& reach, const Choose& choose,
            Image<Pixel>& scratch, Image<Pixel>& result) {
  constexpr int channels = sizeof(Pixel);
  scratch.resize(image.width(), 1);
  result.resize(image.width(), image.height());
  const int count = channels * image.width();
  const auto bytes = [](auto* pixels) {
    using Byte = std::conditional_t<std::is_const_v<std::remove_pointer_t<decltype(pixels)>>,
                                    const std::uint8_t, std::uint8_t>;
    return reinterpret_cast<Byte*>(pixels);
  };
  for (int y = 0; y < image.height(); ++y) {
    std::uint8_t* const column = bytes(scratch.row(0));
    std::uint8_t* const row = bytes(result.row(y));
    std::copy_n(bytes(image.row(y)), count, column);
    for (int dy = 1; dy <= reach.y; ++dy) {
      if (y - dy >= 0) combine(bytes(image.row(y - dy)), count, choose, column);
      if (y + dy < image.height()) combine(bytes(image.row(y + dy)), count, choose, column);
    }
    std::copy_n(column, count, row);
    for (int dx = 1; dx <= reach.x; ++dx) {
      const int offset = channels * dx;
      if (offset >= count) break;
      combine(column + offset, count - offset, choose, row);
      combine(column, count - offset, choose, row + offset);
    }
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
