#pragma once

#include "diminish/image.h"

namespace diminish {

/// Samples of a picture along a straight line, in pixels. For each of them four pixels around it,
/// to the right and below, must be in the picture.
struct Profile {
  static constexpr int most = 65;
  static constexpr int room = 72;  ///< for their levels: whole vectors are written
  float x, y;                      ///< the first one
  float step_x, step_y;            ///< to the next
  int count;
};

/// The levels of the green channel there, bilinear, on vector instructions: what `bilinear` says,
/// bit for bit. levels: `Profile::room` of them.
void sample_profile(ImageView<Bgr> image, const Profile& profile, float* levels);

}  // namespace diminish
