#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "detect/color_blob/conic_fit.h"
#include "detect/color_blob/outline.h"
#include "diminish/image.h"

namespace diminish {

/// How a ball looks in a picture: an ellipse, possibly cut off at the picture's border.
struct RoundShape {
  Ellipse ellipse;
  /// Intersection over union of the region that it was fitted to and the ellipse's visible part.
  double agreement = 0;

  double diameter() const { return ellipse.half_axes.sum(); }
};

/// Whether a region is what a ball may look like.
bool is_round(const RoundShape& shape);

/// Sets the mask's pixels whose centres are inside to 255.
void draw(const Ellipse& ellipse, Mask& mask);

/// Fits round shapes to regions. Keeps its memory from one to the next.
class RoundShapeFitter {
 public:
  /// Fits an ellipse to `outline`, the outer outline of `region` (255 inside); a circle where the
  /// region is cut off, because a short arc says little about an ellipse. A small part of the
  /// outline may be wrong. Nothing if there are too few points for a fit.
  /// picture: what could be seen, in the region's coordinates; it holds the region's mask.
  std::optional<RoundShape> fit(const Outline& outline, const Mask& region, const Rect& picture);

 private:
  /// Takes the points much further from the ellipse than half of them are out of `good_`; returns
  /// whether that changes it.
  bool leave_out_outliers(const Ellipse& ellipse);
  std::optional<Ellipse> fit_good_points(bool is_cut_off) const;

  Outline points_;
  Eigen::AlignedBox2i box_;  ///< of these
  std::vector<char> good_;   ///< of each point
  std::vector<float> distances_px_, sorted_;
};

}  // namespace diminish
