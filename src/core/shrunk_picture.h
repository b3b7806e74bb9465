#pragma once

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

}  // namespace diminish
