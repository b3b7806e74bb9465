#include "pose/lens_trial.h"

#include <algorithm>

#include "pose/known_markers.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

/// Of what the picture costs with the focal length that was said. With good cameras another costs
/// 2 % more at least, by the measured pose or by the refined one.
constexpr float better = 0.99F;

Lens lens_of(Intrinsics color, double factor) {
  color.fx *= factor;
  color.fy *= factor;
  return Lens(color);
}

}  // namespace

LensTrial::LensTrial(const Rig& rig, const Scene& scene)
    : world_marker_(scene.world_marker),
      has_marker_poses_(rig.pose_source == "marker"),
      candidates_{{{1 - step, lens_of(rig.color, 1 - step), {}},
                   {1 + step, lens_of(rig.color, 1 + step), {}}}} {
  for (Candidate& candidate : candidates_) candidate.projection = Projection(candidate.lens);
}

std::optional<RigidTransform> LensTrial::motion(const Candidate& candidate, const Markers& markers,
                                                const Poses& measured) const {
  if (!has_marker_poses_) return RigidTransform{};
  const Marker* const world = find_marker(markers.color, world_marker_.id);
  if (!world || !measured.color_from_world) return std::nullopt;
  const auto pose = estimate_marker_pose(world->corners, world_marker_.size_m, candidate.lens);
  if (!pose) return std::nullopt;
  // Of two poses that explain a square the one that was taken.
  const auto difference = [&](const RigidTransform& color_from_world) {
    return (color_from_world.rotation - measured.color_from_world->rotation).squaredNorm();
  };
  const RigidTransform& nearest =
      difference(pose->alternative) < difference(pose->camera_from_marker)
          ? pose->alternative
          : pose->camera_from_marker;
  return nearest * measured.color_from_world->inverse();
}

std::optional<double> LensTrial::find(const Markers& markers, const Poses& measured,
                                      PoseRefinement& refinement) const {
  const auto own = refinement.costs();
  if (!own) return std::nullopt;
  float least = better;
  std::optional<double> found;
  for (const Candidate& candidate : candidates_) {
    const auto moved = motion(candidate, markers, measured);
    if (!moved) continue;
    // The measured pose may be wrong by chance, the refined one may lie in another valley: not
    // both.
    const auto measured_cost = refinement.measured_cost_with(candidate.projection, *moved);
    if (!measured_cost || !(*measured_cost < better * own->measured)) continue;
    const auto refined_cost = refinement.refined_cost_with(candidate.projection, *moved);
    if (!refined_cost) continue;
    const float ratio = std::max(*measured_cost / own->measured, *refined_cost / own->refined);
    if (!(ratio < least)) continue;
    least = ratio;
    found = candidate.factor;
  }
  return found;
}

}  // namespace diminish
