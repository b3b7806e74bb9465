#pragma once

#include <algorithm>
#include <atomic>

#include "diminish/image.h"
#include "diminish/occlusion_masks.h"

namespace diminish {

/// Of a colour, or of a sum of colours.
inline float brightness(int blue, int green, int red) {
  return 0.114F * static_cast<float>(blue) + 0.587F * static_cast<float>(green) +
         0.299F * static_cast<float>(red);
}

/// The brightness of a picture that is made smaller by a whole factor. Its pixels are made when
/// they are asked for: what reads it here and there pays for what it reads. Threads may read it at
/// the same time.
class ShrunkPicture {
 public:
  /// Both must outlive what is read. occlusion: of the picture's size; what shows an object is not
  /// told.
  void begin(ImageView<Bgr> picture, const Mask& occlusion, int shrinkage);

  int width() const { return levels_.width(); }
  int height() const { return levels_.height(); }

  /// Brightness between pixel centres and its derivatives, in levels a pixel of the small picture.
  struct Brightness {
    float level, dx, dy;
  };
  /// Bilinear. x, y: from 0 up to less than the last column and row. False where one of the four
  /// pixels around may show an object.
  bool look_up(float x, float y, Brightness& found);

 private:
  /// Fills in those of two neighbours of a row that were not asked for before.
  void fill_in(int column, int row);
  float shrink(int column, int row) const;

  ImageView<Bgr> picture_;
  const Mask* occlusion_ = nullptr;
  int shrinkage_ = 1;
  Image<float> levels_;  ///< below 0: unknown as yet, or an object's
};

inline bool ShrunkPicture::look_up(float x, float y, Brightness& found) {
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  float* const first = levels_.row(row) + column;
  float* const second = levels_.row(row + 1) + column;
  float upper[2];
  float lower[2];
  const auto read = [&] {
    for (int i = 0; i < 2; ++i) {
      upper[i] = std::atomic_ref(first[i]).load(std::memory_order_relaxed);
      lower[i] = std::atomic_ref(second[i]).load(std::memory_order_relaxed);
    }
    return std::min(std::min(upper[0], upper[1]), std::min(lower[0], lower[1]));
  };
  if (read() < 0) {
    fill_in(column, row);
    fill_in(column, row + 1);
    if (read() < 0) return false;
  }
  const float u = x - static_cast<float>(column);
  const float v = y - static_cast<float>(row);
  const float above = upper[1] - upper[0];
  const float below = lower[1] - lower[0];
  const float left = upper[0] + u * above;
  found.dy = lower[0] + u * below - left;
  found.dx = above + v * (below - above);
  found.level = left + v * found.dy;
  return true;
}

}  // namespace diminish
