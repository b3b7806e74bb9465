#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "scene/background_planes.h"

namespace diminish {

/// The dark line around the foot of an object that stands on a plane. It reaches beyond the mask,
/// whose margin knows nothing of light, and would stay in the picture when the object is gone.
class ContactLine {
 public:
  /// A shorter line is left: it may be a thing's.
  static constexpr int least_length_px = 24;
  /// What is darker than this share of the plane farther out is a line, and it ends where this is
  /// reached.
  static constexpr float dark = 0.8F, bright = 0.93F;

  explicit ContactLine(const Intrinsics& color) : lens_(color) {}

  struct Inputs {
    ImageView<Bgr> camera;  ///< the colour camera's image
    const Mask& mask;       ///< of the objects, with its margin
    /// The vertices of each object whose shape is known, in the colour camera's frame.
    std::span<const std::vector<Eigen::Vector3d>> objects_m;
    const std::vector<BackgroundPlane>& planes;
    int margin_px;  ///< of the mask
    int reach_px;   ///< how far beyond the mask the line may reach
  };

  /// Finds the line's pixels: outside the mask, some more than once. Only where the mask ends
  /// beside the foot's outline, and only if the line ends within reach: a wide shadow is none.
  /// Cost: 0.1 ms for a foot of 300 pixels' length; nothing where no object touches a plane.
  void find(const Inputs& inputs);
  void clear() { pixels_.clear(); }

  const std::vector<Eigen::Vector2i>& pixels() const { return pixels_; }

 private:
  /// A place on the foot's outline, and what lies outside of it.
  struct Place {
    Eigen::Vector2d pixel, outward;
    int first_px = 0;   ///< from where on it is outside the mask; less than 0: too far away
    int width_px = -1;  ///< of the line; less than 0: none
  };

  bool find_outline(const std::vector<Eigen::Vector3d>& object_m, const BackgroundPlane& plane);
  void list_places();
  void measure(const Inputs& inputs);
  void find_widths(int reach_px);
  void drop_short_ones();
  void list_pixels(const Mask& mask);

  Lens lens_;
  std::vector<Eigen::Vector2d> foot_, hull_;
  std::vector<Place> places_;
  std::vector<float> levels_, sums_;  ///< of each place: brightness by distance from the mask
  std::vector<Eigen::Vector2i> pixels_;
};

}  // namespace diminish
