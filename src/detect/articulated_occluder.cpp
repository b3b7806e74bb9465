#include <fmt/format.h>

#include <memory>
#include <optional>
#include <vector>

#include "detect/articulated/joint_list.h"
#include "detect/articulated/kinematic_chain.h"
#include "detect/shape_detector.h"
#include "detect/silhouette/silhouette.h"
#include "diminish/occluder_settings.h"
#include "geometry/triangle_mesh.h"
#include "source/read_rigid_transform.h"

namespace diminish {
namespace {

/// A robot arm: links of known shape, whose joints a controller reports. Its base stands in the
/// world.
class ArticulatedOccluder final : public ShapeDetector {
 public:
  ArticulatedOccluder(const OccluderSpec& spec, const Rig& rig)
      : name_(spec.name),
        settings_(settings_of<ArticulatedSettings>(spec)),
        rig_(rig),
        chain_(KinematicChain::load(settings_.chain)),
        joints_(JointList::load(settings_.angles, chain_.joint_count())),
        in_color_(Lens(rig.color)) {
    for (const RgbdCamera& camera : rig.rgbd) {
      in_rgbd_color_.emplace_back(Lens(camera.color));
      in_rgbd_depth_.emplace_back(Lens(camera.depth));
    }
    for (const KinematicChain::Link& link : chain_.links()) {
      const TriangleMesh mesh = load_obj(link.mesh);
      const int first = static_cast<int>(vertices_.size());
      link_ends_.push_back(vertices_.size() + mesh.vertices.size());
      vertices_.insert(vertices_.end(), mesh.vertices.begin(), mesh.vertices.end());
      for (const std::array<int, 3>& corners : mesh.triangles) {
        triangles_.push_back({corners[0] + first, corners[1] + first, corners[2] + first});
      }
    }
  }

  void outline(const Observation& observation, std::uint32_t object, ObjectTrack* /*track*/,
               OcclusionOutlines& outlines, OccluderReport& report) override {
    const auto& [frame, markers, poses, options] = observation;
    report.name = name_;
    if (!poses.color_from_world) {
      report.message = name_ + ": where the world is, is not known";
      return;
    }
    if (!joints_.at(frame.stamp_s, settings_.tolerance_s, positions_)) {
      report.message = fmt::format("{}: no joint positions within {:g} s of {:.6f}", name_,
                                   settings_.tolerance_s, frame.stamp_s);
      return;
    }
    add(*poses.color_from_world, in_color_, object, outlines.color);
    outlines.vertices_m[object] = in_camera_;
    for (std::size_t k = 0; k < rig_.rgbd.size(); ++k) {
      const RgbdFrame& rgbd = frame.rgbd[k];
      const auto& depth_from_world = poses.depth_from_world[k];
      if ((!rgbd.has_picture() && !rgbd.is_remote()) || !depth_from_world) continue;
      // Each sensor sees the arm at its own moment.
      if (!joints_.at(rgbd.color_stamp_s, settings_.tolerance_s, positions_)) continue;
      add(rig_.rgbd[k].color_from_depth * *depth_from_world, in_rgbd_color_[k], object,
          outlines.rgbd_color[k]);
      if (!joints_.at(rgbd.depth_stamp_s, settings_.tolerance_s, positions_)) continue;
      add(*depth_from_world, in_rgbd_depth_[k], object, outlines.rgbd_depth[k]);
    }
  }

 private:
  void add(const RigidTransform& camera_from_world, Silhouette& silhouette, std::uint32_t object,
           Polygons& polygons) {
    chain_.move(positions_, base_from_link_);
    const RigidTransform camera_from_base = camera_from_world * settings_.world_from_base;
    in_camera_.clear();
    std::size_t i = 0;
    for (std::size_t link = 0; link < link_ends_.size(); ++link) {
      const RigidTransform camera_from_link = camera_from_base * base_from_link_[link];
      for (; i < link_ends_[link]; ++i) in_camera_.push_back(camera_from_link * vertices_[i]);
    }
    silhouette.outline_triangles(in_camera_, triangles_, object, polygons);
  }

  std::string name_;
  ArticulatedSettings settings_;
  Rig rig_;
  KinematicChain chain_;
  JointList joints_;
  std::vector<Eigen::Vector3d> vertices_;  ///< of all links, each in its own frame
  std::vector<std::size_t> link_ends_;     ///< of each link's vertices
  std::vector<std::array<int, 3>> triangles_;
  Silhouette in_color_;
  std::vector<Silhouette> in_rgbd_color_, in_rgbd_depth_;
  std::vector<double> positions_;
  std::vector<RigidTransform> base_from_link_;
  std::vector<Eigen::Vector3d> in_camera_;
};

std::shared_ptr<const OccluderSettings> read_articulated_settings(const Config& place) {
  place.expect_keys({"name", "detector", "chain", "angles", "base", "tolerance_s"});
  auto settings = std::make_shared<ArticulatedSettings>();
  settings->chain = place.at("chain").path();
  settings->angles = place.at("angles").path();
  if (const Config base = place.find("base"); base.exists()) {
    settings->world_from_base = read_rigid_transform(base);
  }
  if (const Config tolerance = place.find("tolerance_s"); tolerance.exists()) {
    settings->tolerance_s = tolerance.positive_number();
  }
  return settings;
}

const bool articulated_occluder_registered = Registry<OccluderDetector>::add(
    "articulated",
    {.read = read_articulated_settings, .make = [](const OccluderSpec& spec, const Rig& rig) {
       return std::make_unique<ArticulatedOccluder>(spec, rig);
     }});

}  // namespace

std::vector<std::filesystem::path> ArticulatedSettings::files() const {
  std::vector<std::filesystem::path> files = {chain, angles};
  const KinematicChain read = KinematicChain::load(chain);
  for (const KinematicChain::Link& link : read.links()) files.push_back(link.mesh);
  return files;
}

}  // namespace diminish
