#include "setup/calibrate/rig_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/mat.h"
#include "detect/occlusion_masks.h"
#include "diminish/error.h"
#include "pose/camera_poses.h"
#include "pose/frame_markers.h"
#include "pose/pose_refinement.h"
#include "scene/scene_fit.h"
#include "scene/scene_sampler.h"

namespace diminish {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;  ///< rotation vector, translation

constexpr double degree = std::numbers::pi / 180;
constexpr int small_width = 160;
constexpr int usual_width = 640;

RigidTransform transform_of(const Vector6& motion) {
  const double angle = motion.head<3>().norm();
  const Eigen::Vector3d axis =
      angle > 0 ? Eigen::Vector3d(motion.head<3>() / angle) : Eigen::Vector3d::UnitX();
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), motion.tail<3>()};
}

Vector6 vector_of(const RigidTransform& motion) {
  const Eigen::AngleAxisd turn(motion.rotation);
  Vector6 vector;
  vector << turn.angle() * turn.axis(), motion.translation;
  return vector;
}

/// A camera whose images are shrunk to `width`.
Intrinsics shrunk(const Intrinsics& camera, int width) {
  Intrinsics small = camera;
  const double scale = static_cast<double>(width) / camera.width;
  small.width = width;
  small.height = static_cast<int>(std::lround(camera.height * scale));
  small.fx *= scale;
  small.fy *= scale;
  small.cx = (camera.cx + 0.5) * scale - 0.5;
  small.cy = (camera.cy + 0.5) * scale - 0.5;
  return small;
}

/// A frame's picture at one size, without its objects.
struct View {
  Image<Bgr> picture;
  Mask occlusion;
};

View shrink(ImageView<Bgr> picture, const Mask& occlusion, const Intrinsics& camera) {
  View view{{camera.width, camera.height}, {camera.width, camera.height}};
  cv::Mat small = as_mat(view.picture);
  cv::resize(as_mat(picture), small, small.size(), 0, 0, cv::INTER_AREA);
  cv::Mat hidden = as_mat(view.occlusion);
  cv::resize(as_mat(occlusion), hidden, hidden.size(), 0, 0, cv::INTER_NEAREST);
  return view;
}

struct Kept {
  View small, usual, whole;
  std::vector<Image<Bgr>> rgbd;
  SceneSamples samples;
};

/// Those that RGB-D camera `source` - 1 sees, after it has moved.
void move_samples(const SceneSamples& samples, std::uint8_t source, const RigidTransform& moved,
                  const Lens& lens, SceneSamples& result) {
  result.surfaces.clear();
  for (SceneSample sample : samples.surfaces) {
    if (sample.source != source) continue;
    const Eigen::Vector3d point = moved * Eigen::Vector3d(sample.point_m.cast<double>());
    const auto pixel = lens.project(point);
    if (!pixel) continue;
    sample.point_m = point.cast<float>();
    sample.pixel = pixel->cast<float>();
    result.surfaces.push_back(sample);
  }
}

/// How well an RGB-D camera fits the pictures of one size, by its motion.
class Fit {
 public:
  /// color_from_rgbd: before. most: frames to look at.
  Fit(const Intrinsics& camera, const std::vector<Kept>& frames, View Kept::*view, std::size_t most,
      std::uint8_t source, const RigidTransform& color_from_rgbd)
      : lens_(camera),
        fit_(camera),
        view_(view),
        source_(source),
        before_(color_from_rgbd),
        found_(source) {
    for (const Kept& kept : frames) {
      if (frames_.size() == most) break;
      frames_.push_back(&kept);
    }
  }

  /// The mean over the frames; nothing if in none there is enough to tell.
  std::optional<double> operator()(const Vector6& motion) {
    // In its own frame: a turn about its centre.
    const RigidTransform moved = before_ * transform_of(motion) * before_.inverse();
    double sum = 0;
    int count = 0;
    for (const Kept* frame : frames_) {
      move_samples(frame->samples, source_, moved, lens_, moved_);
      const View& view = frame->*view_;
      fit_.find(view.picture, view.occlusion, moved_, found_);
      if (!found_.back()) continue;
      sum += *found_.back();
      ++count;
    }
    return count > 0 ? std::optional(sum / count) : std::nullopt;
  }

 private:
  Lens lens_;
  SceneFit fit_;
  View Kept::*view_;
  std::uint8_t source_;
  RigidTransform before_;
  std::vector<const Kept*> frames_;
  SceneSamples moved_;
  std::vector<std::optional<double>> found_;
};

/// The best of turns on a grid.
Vector6 best_turn(Fit& fit) {
  constexpr int most_steps = 4;
  constexpr double step = 1 * degree;
  Vector6 best = Vector6::Zero();
  double best_fit = -2;
  for (int x = -most_steps; x <= most_steps; ++x) {
    for (int y = -most_steps; y <= most_steps; ++y) {
      for (int z = -most_steps; z <= most_steps; ++z) {
        Vector6 motion = Vector6::Zero();
        motion.head<3>() = step * Eigen::Vector3d(x, y, z);
        const double value = fit(motion).value_or(-1);
        if (value <= best_fit) continue;
        best = motion;
        best_fit = value;
      }
    }
  }
  return best;
}

/// Goes uphill along one degree of freedom after the other, in steps that become smaller.
Vector6 climb(Fit& fit, Vector6 motion, double turn, double least_turn) {
  constexpr double metres_per_radian = 1;
  double best = fit(motion).value_or(-1);
  while (turn >= least_turn) {
    const Vector6 start = motion;
    for (int axis = 0; axis < 6; ++axis) {
      const double step = axis < 3 ? turn : turn * metres_per_radian;
      for (const double sign : {1., -1.}) {
        Vector6 tried = motion;
        tried(axis) += sign * step;
        const double value = fit(tried).value_or(-1);
        if (value <= best) continue;
        best = value;
        motion = tried;
        break;
      }
    }
    if (motion == start) {
      turn /= 2;
      continue;
    }
    // Further along the valley's floor, which no axis follows (Hooke and Jeeves 1961)
    const Vector6 further = 2 * motion - start;
    if (const double value = fit(further).value_or(-1); value > best) {
      best = value;
      motion = further;
    }
  }
  return motion;
}

/// The last tenths of a pixel: the mean of what refines a pose in every frame.
RigidTransform polish(const Rig& rig, const std::vector<Kept>& frames, std::uint8_t source,
                      const RigidTransform& before, RigidTransform pose) {
  constexpr int rounds = 3;
  const Lens lens(rig.color);
  PoseRefinement refinement(rig.color, {.coarser = PoseRefinement::usual_coarser});
  SceneSamples samples;
  for (int round = 0; round < rounds; ++round) {
    Vector6 sum = Vector6::Zero();
    int count = 0;
    for (const Kept& kept : frames) {
      FrameSet frame;
      frame.color = kept.whole.picture;
      frame.rgbd.resize(kept.rgbd.size());
      for (std::size_t k = 0; k < kept.rgbd.size(); ++k) frame.rgbd[k].color = kept.rgbd[k];
      move_samples(kept.samples, source, pose * before.inverse(), lens, samples);
      if (const auto by = refinement.refine(frame, kept.whole.occlusion, samples)) {
        sum += vector_of(*by);
        ++count;
      }
    }
    if (count > 0) pose = transform_of(sum / count) * pose;
  }
  return pose;
}

}  // namespace

struct RigRepair::Implementation {
  Implementation(const Rig& rig_, const Scene& scene)
      : rig(rig_),
        small(shrunk(rig.color, std::min(small_width, rig.color.width))),
        usual(shrunk(rig.color, std::min(usual_width, rig.color.width))),
        poses(rig, scene),
        occluders(rig, scene),
        markers(rig, scene.marker_dictionary, poses.needs_markers() || occluders.needs_markers()),
        sampler(rig),
        seen(rig.rgbd.size(), false) {}

  Rig rig;
  Intrinsics small, usual;
  CameraPoses poses;
  OccluderStage occluders;
  FrameMarkers markers;
  SceneSampler sampler;
  std::vector<Kept> frames;
  std::vector<bool> seen;  ///< whether this RGB-D camera had images at all
  Poses last;
};

RigRepair::RigRepair(const Rig& rig, const Scene& scene) {
  if (rig.pose_source != "fixed") {
    throw Error("rig.yaml: pose.source: expected fixed to repair; got " + rig.pose_source);
  }
  if (rig.rgbd.empty()) {
    throw Error("rig.yaml: rgbd: expected an RGB-D camera whose pose to repair; there is none");
  }
  implementation_ = std::make_unique<Implementation>(rig, scene);
}
RigRepair::~RigRepair() = default;

void RigRepair::add(const FrameSet& frame) {
  Implementation& self = *implementation_;
  if (frame.color.empty() || self.frames.size() == most_frames) return;
  bool is_whole = true;
  for (std::size_t k = 0; k < frame.rgbd.size(); ++k) {
    const RgbdFrame& camera = frame.rgbd[k];
    const bool is_there =
        self.rig.rgbd[k].measures_depth ? camera.available() : camera.has_picture();
    if (is_there) self.seen[k] = true;
    is_whole = is_whole && is_there;
  }
  if (!is_whole) return;
  Markers markers;
  markers.rgbd.resize(self.rig.rgbd.size());
  self.markers.find(frame, markers);
  self.poses.estimate(frame, markers, self.last);
  std::vector<OccluderReport> reports;
  self.occluders.take_turn();
  self.occluders.detect({frame, markers, self.last, Options{}}, reports);
  self.occluders.end_turn();
  const Mask& occlusion = self.occluders.masks().color;
  Kept& kept = self.frames.emplace_back();
  kept.whole = {Image<Bgr>(frame.color.width(), frame.color.height()), occlusion};
  copy(frame.color.view(), kept.whole.picture);
  for (const RgbdFrame& camera : frame.rgbd) {
    Image<Bgr>& picture = kept.rgbd.emplace_back(camera.color.width(), camera.color.height());
    copy(camera.color.view(), picture);
  }
  kept.small = shrink(frame.color, occlusion, self.small);
  kept.usual = shrink(frame.color, occlusion, self.usual);
  self.sampler.sample(frame, self.last, self.occluders.masks(), kept.samples);
}

std::size_t RigRepair::frames() const {
  return implementation_->frames.size();
}

std::vector<RepairedPose> RigRepair::repair() const {
  constexpr std::size_t frames_for_grid = 3;
  constexpr double width_of_top = 0.04;
  const Implementation& self = *implementation_;
  if (self.frames.empty()) {
    const auto unseen = std::find(self.seen.begin(), self.seen.end(), false) - self.seen.begin();
    const std::size_t blamed = std::min<std::size_t>(unseen, self.rig.rgbd.size() - 1);
    throw Error(self.rig.rgbd[blamed].name +
                ": expected frames with its images and those of all other cameras");
  }
  std::vector<RepairedPose> repaired;
  for (std::size_t k = 0; k < self.rig.rgbd.size(); ++k) {
    const RgbdCamera& camera = self.rig.rgbd[k];
    const auto source = static_cast<std::uint8_t>(k + 1);
    const RigidTransform before = *self.last.color_from_depth[k];
    Fit coarse(self.small, self.frames, &Kept::small, frames_for_grid, source, before);
    Fit fine(self.usual, self.frames, &Kept::usual, most_frames, source, before);
    const Vector6 turn = best_turn(coarse);
    Vector6 motion = climb(coarse, turn, 0.5 * degree, 0.1 * degree);
    motion = climb(fine, motion, 0.2 * degree, 0.01 * degree);
    const auto fit_before = fine(Vector6::Zero());
    auto fit = fine(motion);
    // The fit tells where the hill is; on its top, a few pixels wide, the refinement knows better,
    // but no better than a calibration that is there already.
    const auto is_as_good = [&](std::optional<double> other) {
      return other && fit && *other > *fit - width_of_top;
    };
    if (is_as_good(fit_before)) {
      motion.setZero();
    } else {
      const Vector6 polished =
          vector_of(before.inverse() *
                    polish(self.rig, self.frames, source, before, before * transform_of(motion)));
      if (is_as_good(fine(polished))) motion = polished;
    }
    fit = fine(motion);
    if (!fit) {
      throw Error(camera.name +
                  ": what it sees is not in the colour camera's pictures, or has no "
                  "texture; expected both to see the same part of the scene");
    }
    RepairedPose& pose = repaired.emplace_back();
    pose.camera = camera.name;
    pose.color_from_rgbd = before * transform_of(motion) * camera.depth_from_posed;
    pose.turned_deg = motion.head<3>().norm() / degree;
    pose.moved_m = motion.tail<3>().norm();
    pose.fit_before = fit_before.value_or(-1);
    pose.fit = *fit;
  }
  return repaired;
}

}  // namespace diminish
