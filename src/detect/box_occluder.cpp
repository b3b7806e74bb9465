#include <algorithm>
#include <cmath>
#include <vector>

#include "detect/silhouette/disc_dilation.h"
#include "detect/silhouette/silhouette.h"
#include "diminish/occluder_detector.h"
#include "diminish/occluder_settings.h"
#include "geometry/ray_table.h"
#include "geometry/triangle_mesh.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

/// Whatever the RGB-D cameras see inside a box.
class BoxOccluder : public OccluderDetector {
 public:
  BoxOccluder(const OccluderSpec& spec, const Rig& rig)
      : name_(spec.name), rig_(rig), color_drawer_(Lens(rig.color)) {
    const auto& settings = settings_of<BoxSettings>(spec);
    min_ = settings.min_m;
    max_ = settings.max_m;
    if (const RgbdCamera* camera = find_rgbd_camera(rig, settings.frame)) {
      frame_camera_ = static_cast<std::size_t>(camera - rig.rgbd.data());
    }
    for (const RgbdCamera& camera : rig.rgbd) {
      rgbd_drawers_.emplace_back(Lens(camera.color));
      depth_rays_.push_back(RayTable::of(camera.depth));
    }
    meshes_.resize(rig.rgbd.size());
    object_in_rgbd_.resize(rig.rgbd.size());
  }

  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override {
    const auto& [frame, markers, poses, options] = observation;
    const std::size_t count = rig_.rgbd.size();
    OccluderReport report;
    report.name = name_;
    report.in_rgbd.assign(count, false);
    bool any = false;
    for (std::size_t k = 0; k < count; ++k) {
      meshes_[k].vertices.clear();
      meshes_[k].triangles.clear();
      if (!frame.rgbd[k].available()) continue;
      const auto box_from_depth = find_box(k, poses);
      if (!box_from_depth) {
        report.message += (report.message.empty() ? name_ + ": " : ", ") +
                          "where the box is from " + rig_.rgbd[k].name + " is not known";
        continue;
      }
      report.in_rgbd[k] = select_pixels(k, frame.rgbd[k].depth, *box_from_depth,
                                        options.discontinuity_threshold_m, masks.rgbd_depth[k]);
      any = any || report.in_rgbd[k];
    }
    if (!any) {
      if (report.message.empty()) report.message = name_ + ": no RGB-D camera sees anything inside";
      return report;
    }
    report.in_color = draw_in_color(poses, masks.color);
    for (std::size_t k = 0; k < count; ++k) {
      if (frame.rgbd[k].available() && draw_in_rgbd(k, poses, masks.rgbd_color[k])) {
        report.in_rgbd[k] = true;
      }
    }
    return report;
  }

 private:
  /// box_from_depth of camera k.
  std::optional<RigidTransform> find_box(std::size_t k, const Poses& poses) const {
    if (!frame_camera_) {
      if (!poses.depth_from_world[k]) return std::nullopt;
      return poses.depth_from_world[k]->inverse();
    }
    return depth_from_depth(*frame_camera_, k, poses);
  }

  /// To camera `to`'s depth sensor from camera `from`'s.
  static std::optional<RigidTransform> depth_from_depth(std::size_t to, std::size_t from,
                                                        const Poses& poses) {
    if (to == from) return RigidTransform{};
    const auto& color_from_to = poses.color_from_depth[to];
    const auto& color_from_from = poses.color_from_depth[from];
    if (!color_from_to || !color_from_from) return std::nullopt;
    return color_from_to->inverse() * *color_from_from;
  }

  /// Sets the depth pixels that are in the box, and makes the mesh of their surface (SDCT): two
  /// triangles for each four neighbours whose depths differ by less than `threshold_m`. Returns
  /// whether there are any.
  bool select_pixels(std::size_t k, ImageView<std::uint16_t> depth,
                     const RigidTransform& box_from_depth, double threshold_m, Mask& mask) {
    TriangleMesh& mesh = meshes_[k];
    vertex_.resize(depth.width(), depth.height(), -1);
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        if (depth(x, y) == 0) continue;
        const double z = depth(x, y) * rig_.rgbd[k].depth_unit_m;
        const Eigen::Vector3d x_in_depth = z * (*depth_rays_[k])(x, y).cast<double>().homogeneous();
        const Eigen::Vector3d x_in_box = box_from_depth * x_in_depth;
        if ((x_in_box.array() < min_.array() || x_in_box.array() > max_.array()).any()) continue;
        vertex_(x, y) = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(x_in_depth);
        mask(x, y) = 255;
      }
    }
    for (int y = 0; y + 1 < depth.height(); ++y) {
      for (int x = 0; x + 1 < depth.width(); ++x) {
        add_triangle({vertex_(x, y), vertex_(x + 1, y), vertex_(x, y + 1)}, threshold_m, mesh);
        add_triangle({vertex_(x + 1, y), vertex_(x + 1, y + 1), vertex_(x, y + 1)}, threshold_m,
                     mesh);
      }
    }
    return !mesh.vertices.empty();
  }

  static void add_triangle(const std::array<int, 3>& corners, double threshold_m,
                           TriangleMesh& mesh) {
    if (std::any_of(corners.begin(), corners.end(), [](int corner) { return corner < 0; })) return;
    const auto z = [&](int i) { return mesh.vertices[corners[i]].z(); };
    const auto [nearest, farthest] = std::minmax({z(0), z(1), z(2)});
    if (farthest - nearest < threshold_m) mesh.triangles.push_back(corners);
  }

  bool draw_in_color(const Poses& poses, Mask& mask) {
    return draw(rig_.color, color_drawer_, mask, object_in_color_,
                [&](std::size_t from) { return poses.color_from_depth[from]; });
  }

  bool draw_in_rgbd(std::size_t k, const Poses& poses, Mask& mask) {
    return draw(rig_.rgbd[k].color, rgbd_drawers_[k], mask, object_in_rgbd_[k],
                [&](std::size_t from) -> std::optional<RigidTransform> {
                  const auto depth_from_other = depth_from_depth(k, from, poses);
                  if (!depth_from_other) return std::nullopt;
                  return rig_.rgbd[k].color_from_depth * *depth_from_other;
                });
  }

  /// Adds what all RGB-D cameras saw in the box to `mask`, as `camera` sees it.
  /// camera_from_depth(k): absent where not known.
  template <class CameraFromDepth>
  bool draw(const Intrinsics& camera, SilhouetteDrawer& drawer, Mask& mask, Mask& object,
            const CameraFromDepth& camera_from_depth) {
    object.resize(mask.width(), mask.height(), 0);
    bool any = false;
    int widest_px = 0;
    for (std::size_t k = 0; k < meshes_.size(); ++k) {
      if (meshes_[k].triangles.empty()) continue;
      const std::optional<RigidTransform> transform = camera_from_depth(k);
      if (!transform) continue;
      vertices_in_camera_.clear();
      for (const Eigen::Vector3d& x_in_depth : meshes_[k].vertices) {
        vertices_in_camera_.push_back(*transform * x_in_depth);
      }
      any |= drawer.fill_triangles(vertices_in_camera_, meshes_[k].triangles, object);
      const double ratio = camera.fx / rig_.rgbd[k].depth.fx;
      widest_px = std::max(widest_px, static_cast<int>(std::ceil(hole_px * ratio)));
    }
    if (!any) return false;
    dilation_.close(object, widest_px);
    for (int y = 0; y < mask.height(); ++y) {
      std::transform(object.row(y), object.row(y) + mask.width(), mask.row(y), mask.row(y),
                     [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); });
    }
    return true;
  }

  /// Where a surface reflects badly it has no depth: holes of up to about twice this many depth
  /// pixels are closed, so that no pixels of the object are left showing.
  static constexpr int hole_px = 3;

  std::string name_;
  Rig rig_;
  std::optional<std::size_t> frame_camera_;  ///< whose depth frame the box is in; absent: world
  Eigen::Vector3d min_;
  Eigen::Vector3d max_;
  SilhouetteDrawer color_drawer_;
  std::vector<SilhouetteDrawer> rgbd_drawers_;
  std::vector<std::shared_ptr<const RayTable>> depth_rays_;
  std::vector<TriangleMesh>
      meshes_;         ///< what each RGB-D camera sees in the box, in its depth frame
  Image<int> vertex_;  ///< index of a depth pixel's vertex, or -1
  std::vector<Eigen::Vector3d> vertices_in_camera_;
  Mask object_in_color_;
  std::vector<Mask> object_in_rgbd_;
  DiscDilation dilation_;
};

std::shared_ptr<const OccluderSettings> read_box_settings(const Config& place) {
  place.expect_keys({"name", "detector", "frame", "min", "max"});
  auto settings = std::make_shared<BoxSettings>();
  settings->frame = place.at("frame").text();
  settings->min_m = place.at("min").vector3();
  settings->max_m = place.at("max").vector3();
  return settings;
}

const bool box_occluder_registered = Registry<OccluderDetector>::add(
    "box", {.read = read_box_settings, .make = [](const OccluderSpec& spec, const Rig& rig) {
              return std::make_unique<BoxOccluder>(spec, rig);
            }});

}  // namespace
}  // namespace diminish
