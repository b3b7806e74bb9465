#include "setup/check/setup_survey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/robust.h"
#include "pose/camera_poses.h"
#include "pose/known_markers.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

constexpr std::size_t most_frames_kept = 6;
constexpr std::size_t most_faults_kept = 3;

/// Measures brightness and overexposure from every eighth pixel.
void survey_exposure(ImageView<Bgr> image, SensorSurvey& sensor) {
  constexpr int step = 8;
  double sum = 0;
  std::size_t over = 0;
  std::size_t count = 0;
  for (int y = 0; y < image.height(); y += step) {
    for (int x = 0; x < image.width(); x += step) {
      const Bgr& p = image(x, y);
      sum += (p.b + 2.0 * p.g + p.r) / 4;
      over += p.b >= 252 && p.g >= 252 && p.r >= 252 ? 1 : 0;
      ++count;
    }
  }
  sensor.brightness.push_back(sum / static_cast<double>(count));
  sensor.overexposed.push_back(static_cast<double>(over) / static_cast<double>(count));
}

class Surveyor {
 public:
  Surveyor(const Rig& rig, const Scene& scene)
      : rig_(rig),
        sizes_(known_marker_sizes(scene)),
        world_id_(scene.world_marker.size_m > 0 ? scene.world_marker.id : -1),
        poses_(rig, scene),
        detector_(scene.marker_dictionary),
        color_lens_(rig.color) {
    const std::size_t count = rig.rgbd.size();
    for (const RgbdCamera& camera : rig.rgbd) {
      rgbd_lenses_.emplace_back(camera.color);
      survey_.rgbd.emplace_back().name = color_sensor_name(camera);
    }
    survey_.color.name = "color";
    survey_.missing.resize(count);
    survey_.first_missing.resize(count);
    survey_.color_ways.resize(count);
    survey_.rgbd_ways.resize(count);
    survey_.between_px.resize(count);
  }

  SetupSurvey run(FrameSource& source, std::size_t most_frames) {
    const std::size_t known = source.frame_count();
    const std::size_t count = known > 0 ? std::min(known, most_frames) : most_frames;
    double first_stamp = 0;
    FrameSet frame;
    while (survey_.frames < count && source.next(frame)) {
      if (survey_.frames == 0) first_stamp = frame.stamp_s;
      if (survey_.frames > 0) {
        survey_.frame_period_s =
            (frame.stamp_s - first_stamp) / static_cast<double>(survey_.frames);
      }
      Markers markers = look(frame);
      keep(frame, std::move(markers));
      ++survey_.frames;
    }
    return std::move(survey_);
  }

 private:
  /// Keeps every n-th frame. When there are too many, drops every second one. So they stay evenly
  /// spread, however many come.
  void keep(const FrameSet& frame, Markers&& markers) {
    if (survey_.frames % stride_ != 0) return;
    std::vector<SetupSurvey::Kept>& kept = survey_.kept;
    if (kept.size() == most_frames_kept) {
      for (std::size_t i = 1; 2 * i < kept.size(); ++i) kept[i] = std::move(kept[2 * i]);
      kept.resize(most_frames_kept / 2);
      stride_ *= 2;
    }
    if (survey_.frames % stride_ == 0) kept.push_back({frame, std::move(markers)});
  }

  Markers look(const FrameSet& frame) {
    survey_.fault_count += frame.faults.size();
    for (const std::string& fault : frame.faults) {
      if (survey_.faults.size() < most_faults_kept) survey_.faults.push_back(fault);
    }
    Markers markers;
    markers.rgbd.resize(rig_.rgbd.size());
    look_at(frame.color, color_lens_, markers.color, survey_.color);
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      const RgbdFrame& rgbd = frame.rgbd[k];
      if (!rgbd.has_picture() && survey_.missing[k]++ == 0) {
        survey_.first_missing[k] = rgbd.missing;
      }
      look_at(rgbd.color, rgbd_lenses_[k], markers.rgbd[k], survey_.rgbd[k]);
    }
    if (frame.color.empty()) return markers;
    Poses poses;
    poses_.estimate(frame, markers, poses);
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) follow(frame, markers, poses, k);
    return markers;
  }

  void look_at(ImageView<Bgr> image, const Lens& lens, std::vector<Marker>& markers,
               SensorSurvey& sensor) {
    if (image.empty()) return;
    ++sensor.images;
    survey_exposure(image, sensor);
    detector_.detect(image, lens, markers);
    for (const Marker& marker : markers) {
      const auto size = sizes_.find(marker.id);
      if (size == sizes_.end()) continue;
      auto& statistics = sensor.markers[marker.id];
      ++statistics.count;
      statistics.sides_px.push_back(mean_side_px(marker));
      if (const auto pose = estimate_marker_pose(marker.corners, size->second, lens)) {
        statistics.errors_px.push_back(pose->error_px);
      }
    }
  }

  /// Records the paths of markers that both cameras see, and how well the cameras agree on their
  /// places.
  void follow(const FrameSet& frame, const Markers& markers, const Poses& poses, std::size_t k) {
    if (!poses.color_from_depth[k] || !frame.rgbd[k].has_picture()) return;
    const RigidTransform color_from_rgbd =
        *poses.color_from_depth[k] * rig_.rgbd[k].color_from_depth.inverse();
    // If the poses come from the world marker, its place always agrees.
    const bool by_world = rig_.pose_source == "marker";
    const int skip = by_world ? world_id_ : -1;
    const auto errors = errors_between(markers.color, markers.rgbd[k], sizes_, color_lens_,
                                       rgbd_lenses_[k], color_from_rgbd, skip);
    survey_.between_px[k].insert(survey_.between_px[k].end(), errors.begin(), errors.end());
    for (const Marker& seen : markers.rgbd[k]) {
      const auto size = sizes_.find(seen.id);
      const Marker* in_color = find_marker(markers.color, seen.id);
      if (size == sizes_.end() || !in_color || seen.id == skip) continue;
      const auto rgbd_pose = estimate_marker_pose(seen.corners, size->second, rgbd_lenses_[k]);
      const auto color_pose = estimate_marker_pose(in_color->corners, size->second, color_lens_);
      if (!rgbd_pose || !color_pose) continue;
      RigidTransform common_from_color;
      RigidTransform common_from_rgbd = color_from_rgbd;
      if (by_world) {
        if (!poses.color_from_world || !poses.depth_from_world[k]) continue;
        common_from_color = poses.color_from_world->inverse();
        common_from_rgbd =
            poses.depth_from_world[k]->inverse() * rig_.rgbd[k].color_from_depth.inverse();
      }
      survey_.color_ways[k][seen.id].push_back(
          {frame.stamp_s, common_from_color * color_pose->camera_from_marker.translation});
      survey_.rgbd_ways[k][seen.id].push_back(
          {frame.rgbd[k].color_stamp_s,
           common_from_rgbd * rgbd_pose->camera_from_marker.translation});
    }
  }

  Rig rig_;
  std::map<int, double> sizes_;
  int world_id_;
  CameraPoses poses_;
  MarkerDetector detector_;
  Lens color_lens_;
  std::vector<Lens> rgbd_lenses_;
  SetupSurvey survey_;
  std::size_t stride_ = 1;
};

}  // namespace

double mean_side_px(const Marker& marker) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    sum += (marker.corners[i] - marker.corners[(i + 1) % 4]).norm();
  }
  return sum / 4;
}

std::vector<double> errors_between(const std::vector<Marker>& in_color,
                                   const std::vector<Marker>& in_rgbd,
                                   const std::map<int, double>& sizes_m, const Lens& color_lens,
                                   const Lens& rgbd_lens, const RigidTransform& color_from_rgbd,
                                   int skip) {
  std::vector<double> errors;
  for (const Marker& seen : in_rgbd) {
    const auto size = sizes_m.find(seen.id);
    const Marker* same = find_marker(in_color, seen.id);
    if (size == sizes_m.end() || !same || seen.id == skip) continue;
    const auto pose = estimate_marker_pose(seen.corners, size->second, rgbd_lens);
    if (!pose) continue;
    double error = std::numeric_limits<double>::infinity();
    for (const RigidTransform& solution : {pose->camera_from_marker, pose->alternative}) {
      error = std::min(error, marker_error_px(color_from_rgbd * solution, size->second, color_lens,
                                              same->corners));
    }
    if (std::isfinite(error)) errors.push_back(error);
  }
  return errors;
}

SetupSurvey survey_setup(const Rig& rig, const Scene& scene, FrameSource& source,
                         std::size_t most_frames) {
  return Surveyor(rig, scene).run(source, most_frames);
}

}  // namespace diminish
