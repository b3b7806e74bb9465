#include <algorithm>
#include <vector>

#include "detect/marker_views.h"
#include "detect/shape_detector.h"
#include "detect/silhouette/silhouette.h"
#include "diminish/occluder_settings.h"
#include "geometry/triangle_mesh.h"
#include "pose/known_markers.h"
#include "pose/marker_pose.h"

namespace diminish {
namespace {

TriangleMesh shape_of(const MarkerSettings& settings) {
  if (!settings.mesh.empty()) return load_obj(settings.mesh);
  return {settings.vertices, settings.triangles};
}

/// An object with a marker on it, whose shape in the marker's frame is known.
class MarkerOccluder : public ShapeDetector {
 public:
  MarkerOccluder(const OccluderSpec& spec, const Rig& rig)
      : MarkerOccluder(spec.name, settings_of<MarkerSettings>(spec), rig) {}
  MarkerOccluder(const std::string& name, const MarkerSettings& settings, const Rig& rig)
      : name_(name),
        rig_(rig),
        marker_(settings.marker),
        shape_(shape_of(settings)),
        color_lens_(rig.color),
        in_color_(color_lens_) {
    for (const RgbdCamera& camera : rig.rgbd) {
      rgbd_color_lenses_.emplace_back(camera.color);
      in_rgbd_color_.emplace_back(rgbd_color_lenses_.back());
      in_rgbd_depth_.emplace_back(Lens(camera.depth));
    }
  }

  bool needs_markers() const override { return true; }

  void outline(const Observation& observation, std::uint32_t object, ObjectTrack* track,
               OcclusionOutlines& outlines, OccluderReport& report) override {
    // The colour camera first, then the RGB-D cameras' colour sensors.
    views_.clear();
    views_.push_back({&color_lens_, corners_in(observation.markers.color), RigidTransform{}});
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      MarkerView view{&rgbd_color_lenses_[k], corners_in(observation.markers.rgbd[k]), {}};
      if (const auto& color_from_depth = observation.poses.color_from_depth[k]) {
        view.common_from_camera = *color_from_depth * rig_.rgbd[k].color_from_depth.inverse();
      }
      views_.push_back(view);
    }
    locate_marker(views_, marker_.size_m, camera_from_marker_);
    const bool is_continued = track && follow(observation, *track);

    if (const auto& pose = camera_from_marker_[0]) {
      add_shape(*pose, in_color_, object, outlines.color);
      outlines.vertices_m[object] = vertices_in_camera_;
    }
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      const auto& pose = camera_from_marker_[k + 1];
      if (!pose || !observation.frame.rgbd[k].takes_part()) continue;
      add_shape(*pose, in_rgbd_color_[k], object, outlines.rgbd_color[k]);
      add_shape(rig_.rgbd[k].color_from_depth.inverse() * *pose, in_rgbd_depth_[k], object,
                outlines.rgbd_depth[k]);
    }
    report.name = name_;
    report.message = message();
    if (is_continued) report.message += "; continued by its last motion";
  }

 private:
  bool is_seen() const {
    return std::any_of(views_.begin(), views_.end(), [](const auto& view) { return view.corners; });
  }

  /// If no camera sees the marker, puts it where its last motion takes it, and returns true. The
  /// frame that stands still is the world, or else the first RGB-D camera.
  bool follow(const Observation& observation, ObjectTrack& track) {
    const Poses& poses = observation.poses;
    const bool is_world = poses.color_from_world.has_value();
    const std::optional<RigidTransform>& color_from_frame =
        is_world || poses.color_from_depth.empty() ? poses.color_from_world
                                                   : poses.color_from_depth[0];
    const double stamp_s = observation.frame.stamp_s;
    if (!color_from_frame) return false;
    std::optional<RigidTransform>& color_from_marker = camera_from_marker_[0];
    if (is_seen()) {
      if (color_from_marker) {
        track.add(stamp_s, is_world, color_from_frame->inverse() * *color_from_marker);
      }
      return false;
    }
    const auto frame_from_marker = track.at(stamp_s, is_world);
    if (!frame_from_marker) return false;
    color_from_marker = *color_from_frame * *frame_from_marker;
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      const auto& color_from_rgbd = views_[k + 1].common_from_camera;
      if (color_from_rgbd)
        camera_from_marker_[k + 1] = color_from_rgbd->inverse() * *color_from_marker;
    }
    return true;
  }

  std::optional<std::array<Eigen::Vector2d, 4>> corners_in(const std::vector<Marker>& seen) const {
    const Marker* found = find_marker(seen, marker_.id);
    if (!found) return std::nullopt;
    return found->corners;
  }

  void add_shape(const RigidTransform& camera_from_marker, Silhouette& silhouette,
                 std::uint32_t object, Polygons& polygons) {
    vertices_in_camera_.clear();
    for (const Eigen::Vector3d& vertex : shape_.vertices) {
      vertices_in_camera_.push_back(camera_from_marker * vertex);
    }
    if (shape_.triangles.empty()) {
      silhouette.outline_convex_hull(vertices_in_camera_, object, polygons);
    } else {
      silhouette.outline_triangles(vertices_in_camera_, shape_.triangles, object, polygons);
    }
  }

  /// What is missing. An object that is out of a camera's sight is not: its place is known.
  std::string message() const {
    const auto marker = [&] { return name_ + ": marker " + std::to_string(marker_.id); };
    if (!is_seen()) return marker() + " not visible in any camera";
    std::string cameras;
    for (std::size_t i = 0; i < camera_from_marker_.size(); ++i) {
      if (camera_from_marker_[i]) continue;
      cameras += (cameras.empty() ? "" : ", ") +
                 (i == 0 ? std::string("color") : color_sensor_name(rig_.rgbd[i - 1]));
    }
    if (cameras.empty()) return "";
    return marker() + " not visible in " + cameras +
           ", and the way there from a camera that sees it is not known";
  }

  std::string name_;
  Rig rig_;
  MarkerSpec marker_;
  TriangleMesh shape_;  ///< in the marker's frame; without triangles: its convex hull
  Lens color_lens_;
  std::vector<Lens> rgbd_color_lenses_;
  Silhouette in_color_;
  std::vector<Silhouette> in_rgbd_color_, in_rgbd_depth_;
  std::vector<Eigen::Vector3d> vertices_in_camera_;
  std::vector<MarkerView> views_;                                  ///< of this frame
  std::vector<std::optional<RigidTransform>> camera_from_marker_;  ///< of each view
};

std::shared_ptr<const OccluderSettings> read_marker_settings(const Config& place) {
  place.expect_keys({"name", "detector", "marker", "vertices", "mesh"});
  auto settings = std::make_shared<MarkerSettings>();
  settings->marker = read_marker(place.at("marker"));
  const Config vertices = place.find("vertices");
  if (vertices.exists()) {
    for (const Config& item : vertices.items()) settings->vertices.push_back(item.vector3());
    if (settings->vertices.empty()) vertices.fail("expected at least 4 points");
  }
  if (const Config mesh = place.find("mesh"); mesh.exists()) settings->mesh = mesh.path();
  return settings;
}

const bool marker_occluder_registered = Registry<OccluderDetector>::add(
    "marker", {.read = read_marker_settings, .make = [](const OccluderSpec& spec, const Rig& rig) {
                 return std::make_unique<MarkerOccluder>(spec, rig);
               }});

}  // namespace
}  // namespace diminish
