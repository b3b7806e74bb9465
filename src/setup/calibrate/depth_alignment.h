#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"
#include "setup/calibrate/target_view.h"

namespace diminish {

/// Finds color_from_depth of an RGB-D camera. Flat targets are planes in the colour sensor's frame,
/// and the depth measured on them must lie on these planes. One plane determines three of the six
/// unknowns; planes tilted in different directions determine all.
class DepthAlignment {
 public:
  DepthAlignment(const Lens& depth_lens, double depth_unit_m,
                 const RigidTransform& color_from_depth);

  /// Keeps up to 400 depth points around the target, and up to 400 targets. Ignores targets without
  /// enough depth.
  void add(const TargetView& in_color, ImageView<std::uint16_t> depth);

  std::size_t size() const { return planes_.size(); }

  struct Result {
    RigidTransform color_from_depth;
    double error_before_m = 0;  ///< root mean square of the planes' mean distances
    double error_m = 0;         ///< the same with the result
    int determined = 0;         ///< of six degrees of freedom
    /// Those that the targets do not determine, in plain words. They keep their given values.
    std::vector<std::string> undetermined;
    /// Standard deviation of the worst determined one, at the targets' place.
    double deviation_m = 0;
  };
  /// Gauss-Newton on point-to-plane distances, robust over targets (Tukey's weights).
  Result solve() const;

 private:
  struct Plane {
    RigidTransform color_from_target, alternative;
    bool doubtful = false;
    Eigen::Vector2d low, high;
    std::vector<Eigen::Vector3d> points_m;  ///< in the depth frame
  };
  struct Row;
  static bool fit(const Plane& plane, const RigidTransform& color_from_depth, Row& row);
  std::vector<Row> rows(const RigidTransform& color_from_depth) const;

  Lens depth_lens_;
  double depth_unit_m_;
  RigidTransform color_from_depth_;
  std::vector<Plane> planes_;
};

}  // namespace diminish
