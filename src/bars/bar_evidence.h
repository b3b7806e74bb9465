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
  /// anyway. What is less than `least` may be any such number, and is found with fewer looks.
  float margin(const BackgroundPlane& plane, float least) const;

 private:
  /// Rays along the bar, at some distance from its middle. In an order in which the first few are
  /// spread over all of it.
  struct Strip {
    static constexpr int most = 2 * DepthView::few;
    std::array<float, most> ray_x{}, ray_y{};
    int count = 0;
  };
  /// On the bar, and to each side of it nearer and further away.
  struct Side {
    Strip near, far;
  };
  Strip strip(const Bar& bar, float begin, float end, float side) const;
  /// The share of places where no depth is measured. Nothing if too little is known, nor if it is
  /// less than `least` or more than `most`: it stops when it knows.
  std::optional<float> bare_share(const Strip& strip, const BackgroundPlane& plane, float least,
                                  float most) const;

  const BarViews& views_;
  Strip middle_;
  std::array<Side, 2> sides_;
};

/// The edges of a bar in the RGB-D cameras' pictures.
class BarEdges {
 public:
  static constexpr int longest_px = 280;

  /// begin, end: along the bar, at most `longest_px` apart.
  BarEdges(const BarViews& views, const Bar& bar, float begin, float end);

  /// How clearly an RGB-D camera's picture shows the less clear edge of the bar if it is in this
  /// plane, in grey levels: the mean over pieces of the size of each one's mean step. In the camera
  /// that shows both best. What is not more than `least` may be any such number.
  float contrast(const BackgroundPlane& plane, float least) const;

 private:
  static constexpr int step_px = 5;
  static constexpr int most = longest_px / step_px + 1;
  /// Of an edge: the rays on its one side and on its other.
  struct Edge {
    std::array<Eigen::Vector3f, most> left, right;
  };
  float contrast(std::size_t k, const BackgroundPlane& plane, const Edge& edge) const;

  const BarViews& views_;
  int places_;
  std::array<Edge, 2> edges_;
};

}  // namespace diminish
