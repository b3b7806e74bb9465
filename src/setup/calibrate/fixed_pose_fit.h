#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"
#include "geometry/ideal_camera.h"
#include "setup/calibrate/target_view.h"

namespace diminish {

/// Finds the transform between two cameras that do not move against each other, from targets that
/// both saw at the same time. Robust least squares (Tukey's weights) on the reprojection errors of
/// all corners in both images, with each target's pose as a further unknown.
class FixedPoseFit {
 public:
  FixedPoseFit(const Lens& first, const Lens& second);

  /// The same target in both images. Keeps up to 400.
  void add(const TargetView& in_first, const TargetView& in_second);

  std::size_t size() const { return sightings_.size(); }

  struct Result {
    RigidTransform first_from_second;
    /// Root mean square of the corners' errors in both images, pixels, over the sightings that
    /// agree.
    double error_px = 0;
    /// The same if every sighting had its own transform: what the corners' noise alone causes.
    double least_error_px = 0;
    std::size_t agreeing = 0;  ///< sightings
    /// Standard deviations.
    double deviation_m = 0;
    double deviation_deg = 0;
  };
  /// Nothing without sightings.
  std::optional<Result> solve() const;

 private:
  struct Sighting {
    TargetView first, second;
    std::vector<Eigen::Vector2d> first_px, second_px;  ///< as the ideal cameras see them
  };
  double transfer_error_px(const Sighting& sighting, const RigidTransform& first_from_second,
                           RigidTransform* second_from_target) const;
  RigidTransform start() const;

  struct Poses;
  struct Linearised;
  /// The sum of the corners' squared errors in both images, in square pixels.
  double squared_error(const Sighting& sighting, const RigidTransform& first_from_second,
                       const RigidTransform& second_from_target) const;
  /// Each sighting's root mean square error.
  std::vector<double> errors_px(const Poses& poses) const;
  std::vector<double> weights(const Poses& poses) const;
  Linearised linearise(const Poses& poses, const std::vector<double>& weights) const;
  std::optional<Result> summarise(const Poses& poses, const std::vector<double>& weights) const;

  Lens first_lens_, second_lens_;
  IdealCamera first_, second_;
  std::vector<Sighting> sightings_;
};

}  // namespace diminish
