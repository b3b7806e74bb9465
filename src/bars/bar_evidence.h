#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "bars/bar.h"
#include "bars/bar_views.h"

namespace diminish {

/// Where the ray meets the plane; behind the camera if it does not.
Eigen::Vector3f meet(const BackgroundPlane& plane, const Eigen::Vector3f& ray);

/// The hole that a bar leaves in depth images, if it is there.
class BarHole {
 public:
  /// begin, end: along the bar.
  BarHole(const BarViews& views, const Bar& bar, float begin, float end);

  /// If the bar is in this plane: the share of its places where no depth is measured, less that
  /// beside it. 0 where too little is known, and where most of it has depth: then it is drawn
  /// anyway.
  float margin(const BackgroundPlane& plane) const;

 private:
  /// Rays along the bar, at some distance from its middle.
  struct Strip {
    static constexpr int most = 32;
    std::array<Eigen::Vector3f, most> rays;
    int count = 0;
  };
  /// On the bar, and to each side of it nearer and further away.
  struct Side {
    Strip near, far;
  };
  Strip strip(const Bar& bar, float begin, float end, float side) const;
  std::optional<float> bare_share(const Strip& strip, const BackgroundPlane& plane) const;

  const BarViews& views_;
  Strip middle_;
  std::array<Side, 2> sides_;
};

/// How clearly an RGB-D camera's picture shows the less clear edge of the bar, in grey levels: the
/// mean over pieces of the size of each one's mean step. In the camera that shows both best.
float edge_contrast(const BarViews& views, const Bar& bar, float begin, float end);

}  // namespace diminish
