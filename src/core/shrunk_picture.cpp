#include "core/shrunk_picture.h"

#include <atomic>

namespace diminish {
namespace {

constexpr float not_yet = -1;
constexpr float object = -2;

}  // namespace

void ShrunkPicture::begin(ImageView<Bgr> picture, const Mask& occlusion, int shrinkage) {
  picture_ = picture;
  occlusion_ = &occlusion;
  shrinkage_ = shrinkage;
  levels_.resize(picture.width() / shrinkage, picture.height() / shrinkage);
  levels_.fill(not_yet);
}

void ShrunkPicture::fill_in(int column, int row) {
  for (int x = column; x < column + 2; ++x) {
    // Two threads that fill in the same pixel write the same.
    const std::atomic_ref<float> own(levels_(x, row));
    if (own.load(std::memory_order_relaxed) == not_yet) {
      own.store(shrink(x, row), std::memory_order_relaxed);
    }
  }
}

/// Of the square of pixels that makes one, four are enough: they blur as much.
float ShrunkPicture::shrink(int column, int row) const {
  const int left = shrinkage_ * column;
  const int top = shrinkage_ * row;
  const int right = left + shrinkage_ - 1;
  const int bottom = top + shrinkage_ - 1;
  const Mask& occlusion = *occlusion_;
  if ((occlusion(left, top) | occlusion(right, top) | occlusion(left, bottom) |
       occlusion(right, bottom)) != 0) {
    return object;
  }
  int blue = 0;
  int green = 0;
  int red = 0;
  for (const int y : {top, top + shrinkage_ / 2}) {
    for (const int x : {left, left + shrinkage_ / 2}) {
      const Bgr& color = picture_(x, y);
      blue += color.b;
      green += color.g;
      red += color.r;
    }
  }
  return brightness(blue, green, red) / 4;
}

}  // namespace diminish
