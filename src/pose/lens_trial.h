#pragma once

#include <array>
#include <optional>

#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene.h"
#include "geometry/projection.h"
#include "pose/pose_refinement.h"

namespace diminish {

/// Whether the colour camera's picture is explained better by another focal length. A pose that is
/// found from one marker makes good what a wrong one does near the marker, and a refined pose more
/// of it: so each focal length is tried with the poses that it would lead to.
class LensTrial {
 public:
  /// How far those that are tried are from what was said.
  static constexpr double step = 0.05;

  LensTrial(const Rig& rig, const Scene& scene);

  /// After refinement.refine with this frame, its markers and poses as they were measured. Returns
  /// by what the focal length is to be multiplied, about: 1 + step or 1 - step. Nothing if it is
  /// right, or too little is seen. Cost: an eighth of refine's; two thirds where it is wrong.
  std::optional<double> find(const Markers& markers, const Poses& measured,
                             PoseRefinement& refinement) const;

 private:
  struct Candidate {
    double factor;
    Lens lens;
    Projection projection;
  };
  /// How the measured pose moves with this lens.
  std::optional<RigidTransform> motion(const Candidate& candidate, const Markers& markers,
                                       const Poses& measured) const;

  MarkerSpec world_marker_;
  bool has_marker_poses_;
  std::array<Candidate, 2> candidates_;
};

}  // namespace diminish
