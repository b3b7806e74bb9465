#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "geometry/projection.h"

namespace diminish {

/// A picture's brightness, made smaller by a whole factor.
class GreyPicture {
 public:
  GreyPicture(const Intrinsics& camera, int shrinkage);

  /// Cost: one pass.
  void take(ImageView<Bgr> picture);

  const Image<std::uint8_t>& pixels() const { return pixels_; }
  /// Of the small picture.
  const Projection& projection() const { return projection_; }

 private:
  Projection projection_;
  int shrinkage_;
  std::vector<std::uint16_t> scratch_;
  Image<Bgr> small_;
  Image<std::uint8_t> pixels_;
};

/// Part of what a camera without lens distortion sees.
struct TurnedView {
  /// In pixels of that camera's picture; it may reach beyond its borders.
  Rect window;
  /// unknown_grey where the picture that it is made of shows nothing.
  Image<std::uint8_t> grey;
};

/// What a camera without distortion sees from the same place, turned another way. view: its
/// pinhole. camera_from_view: the rotation. window: at most 16384 pixels wide. Cost: 3 ns per
/// pixel, shared by threads.
void turn(const GreyPicture& picture, const Eigen::Matrix3d& camera_from_view,
          const Intrinsics& view, const Rect& window, TurnedView& turned);

/// The view at half the resolution; the window's sides are even. Its pixels are known where all
/// four are.
void halve(const TurnedView& view, TurnedView& small);

}  // namespace diminish
