#include "pose/pose_refinement.h"

#include <algorithm>
#include <numbers>

#include "core/tasks.h"

namespace diminish {
namespace {

constexpr int most_iterations = 10;
constexpr std::size_t fewest_samples = 150;
constexpr std::size_t most_points = 2400;

/// What a marker leaves open, and what is taken for a mistake.
constexpr float rotation_deviation = 0.5F * std::numbers::pi_v<float> / 180;
constexpr float translation_deviation_m = 0.012F;
constexpr float largest_deviations = 4;

DirectAlignment::Twist deviations(float reach) {
  DirectAlignment::Twist all;
  all.head<3>().setConstant(reach * translation_deviation_m);
  all.tail<3>().setConstant(reach * rotation_deviation);
  return all;
}

int shrinkage_of(const Intrinsics& color, int small_width) {
  return std::max(1, (color.width + small_width / 2) / small_width);
}

}  // namespace

std::array<int, 1 + PoseRefinement::usual_coarser> PoseRefinement::usual_spacings_px(
    const Intrinsics& color) {
  std::array<int, 1 + usual_coarser> spacings{};
  for (int coarser = 0; coarser <= usual_coarser; ++coarser) {
    spacings[static_cast<std::size_t>(coarser)] = (shrinkage_of(color, usual_width) << coarser) / 2;
  }
  return spacings;
}

PoseRefinement::PoseRefinement(const Intrinsics& color, const PoseRefinementSettings& settings)
    : reach_(settings.reach),
      fine_(color,
            {shrinkage_of(color, settings.small_width), most_points, settings.last_step,
             settings.extrapolates},
            deviations(settings.reach)),
      projection_(Lens(color)) {
  const int shrinkage = shrinkage_of(color, settings.small_width);
  for (int coarser = settings.coarser; coarser > 0; --coarser) {
    coarser_.emplace_back(color,
                          DirectAlignment::Settings{shrinkage << coarser, most_points / 2,
                                                    5 * settings.last_step, true},
                          deviations(settings.reach));
  }
  has_begun_.resize(coarser_.size());
}

std::optional<RigidTransform> PoseRefinement::refine(const FrameSet& frame, const Mask& occlusion,
                                                     const SceneSamples& scene) {
  costs_.reset();
  if (scene.surfaces.size() < fewest_samples) return std::nullopt;
  // The pose as it was measured is to be bettered.
  DirectAlignment::Estimate measured;
  DirectAlignment::Estimate estimate;
  bool is_seen = false;
  do_all([&] { is_seen = fine_.begin(frame, occlusion, scene) && fine_.iterate(0, measured); },
         [&] {
           for_tasks(coarser_.size(), [&](std::size_t i) {
             has_begun_[i] = coarser_[i].begin(frame, occlusion, scene) ? 1 : 0;
           });
           for (std::size_t i = 0; i < coarser_.size(); ++i) {
             if (has_begun_[i] == 0 || !coarser_[i].iterate(most_iterations, estimate))
               estimate = {};
           }
         });
  if (!is_seen || !fine_.iterate(most_iterations, estimate)) return std::nullopt;
  estimate_ = estimate;
  costs_ = {measured.cost, estimate.cost};
  if (!(estimate.cost < measured.cost) ||
      estimate.twist.head<3>().norm() > reach_ * largest_deviations * translation_deviation_m ||
      estimate.twist.tail<3>().norm() > reach_ * largest_deviations * rotation_deviation) {
    return std::nullopt;
  }
  return estimate.correction;
}

std::optional<float> PoseRefinement::measured_cost_with(const Projection& other,
                                                        const RigidTransform& moved) {
  if (!costs_) return std::nullopt;
  DirectAlignment::Estimate measured;
  measured.correction = moved;
  fine_.change_lens(other);
  const bool is_seen = fine_.iterate(0, measured);
  fine_.change_lens(projection_);
  if (!is_seen) return std::nullopt;
  return measured.cost;
}

std::optional<float> PoseRefinement::refined_cost_with(const Projection& other,
                                                       const RigidTransform& moved) {
  if (!costs_) return std::nullopt;
  // From one of the two it is not far: as measured, or as found with the own lens.
  constexpr int iterations = 4;
  DirectAlignment::Estimate measured;
  measured.correction = moved;
  DirectAlignment::Estimate refined = estimate_;
  refined.correction = estimate_.correction * moved;
  fine_.change_lens(other);
  bool is_seen = fine_.iterate(0, measured) && fine_.iterate(0, refined);
  if (is_seen && measured.cost < refined.cost) refined = measured;
  is_seen = is_seen && fine_.iterate(iterations, refined);
  fine_.change_lens(projection_);
  if (!is_seen) return std::nullopt;
  return refined.cost;
}

void PoseRefinement::apply(const RigidTransform& correction, Poses& poses,
                           SceneSamples& samples) const {
  for (auto& pose : poses.color_from_depth) {
    if (pose) pose = correction * *pose;
  }
  if (poses.color_from_world) poses.color_from_world = correction * *poses.color_from_world;
  const Eigen::Matrix3f rotation = correction.rotation.cast<float>();
  const Eigen::Vector3f translation = correction.translation.cast<float>();
  for (Eigen::Vector3f& point_m : samples.object_points_m) {
    point_m = rotation * point_m + translation;
  }
  for (SceneSample& sample : samples.surfaces) {
    const Eigen::Vector3f p = rotation * sample.point_m + translation;
    sample.point_m = p;
    if (!(p.z() > 0) ||
        !projection_.distort(p.x() / p.z(), p.y() / p.z(), sample.pixel.x(), sample.pixel.y())) {
      sample.pixel.setConstant(-1);
    }
  }
}

}  // namespace diminish
