#include "detect/color_blob/smooth_picture.h"

namespace diminish {
namespace {

void sum_rows(const std::uint8_t* above, const std::uint8_t* middle, const std::uint8_t* below,
              int count, std::uint16_t* __restrict sums) {
  for (int i = 0; i < count; ++i) {
    sums[i] = static_cast<std::uint16_t>(above[i] + 2 * middle[i] + below[i]);
  }
}

/// From sums that are one pixel (3) apart.
void average_columns(const std::uint16_t* sums, int count, std::uint8_t* __restrict result) {
  for (int i = 0; i < count; ++i) {
    const auto sum = static_cast<std::uint16_t>(sums[i] + 2 * sums[i + 3] + sums[i + 6] + 8);
    result[i] = static_cast<std::uint8_t>(sum >> 4);
  }
}

}  // namespace

const std::uint8_t* PictureSmoother::row(ImageView<Bgr> picture, int y, int first, int last,
                                         std::vector<Bgr>& scratch) {
  const Bgr* const pixels = picture.row(std::clamp(y, 0, picture.height() - 1));
  if (first >= 0 && last <= picture.width()) {
    return reinterpret_cast<const std::uint8_t*>(pixels + first);
  }
  scratch.resize(static_cast<std::size_t>(last - first));
  auto to = scratch.begin();
  int x = first;
  for (; x < std::min(last, 0); ++x) *to++ = pixels[0];
  const int end = std::min(last, picture.width());
  if (x < end) {
    to = std::copy(pixels + x, pixels + end, to);
    x = end;
  }
  for (; x < last; ++x) *to++ = pixels[picture.width() - 1];
  return reinterpret_cast<const std::uint8_t*>(scratch.data());
}

void PictureSmoother::smooth_row(ImageView<Bgr> picture, const Rect& part, int y, int first,
                                 int last, Bgr* result) {
  const int left = part.x + first - 1;
  const int right = part.x + last + 1;
  const int middle = part.y + y;
  const int count = 3 * (right - left);
  sums_.resize(static_cast<std::size_t>(count));
  sum_rows(row(picture, middle - 1, left, right, outside_[0]),
           row(picture, middle, left, right, outside_[1]),
           row(picture, middle + 1, left, right, outside_[2]), count, sums_.data());
  average_columns(sums_.data(), count - 6, reinterpret_cast<std::uint8_t*>(result));
}

}  // namespace diminish
