#include "diminish/validate.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "core/limits.h"
#include "core/text.h"
#include "diminish/occluder_detector.h"
#include "diminish/pose_source.h"
#include "source/configuration_checks.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

/// A pixel's provenance has this many values for RGB-D cameras.
constexpr std::size_t max_rgbd_cameras = 253;

void check_integer(int value, int min, int max, const Config& place) {
  if (value >= min && value <= max) return;
  place.fail(fmt::format("expected a whole number from {} to {}, got '{}'", min, max, value));
}

void check_positive(double value, const Config& place) {
  if (std::isfinite(value) && value > 0) return;
  place.fail(fmt::format("expected a number above 0, got '{}'", value));
}

void check_focal_length(double value, int side, const Config& place) {
  // A field of view between 0.6 and 179 degrees; beyond that it is not in pixels.
  const double shortest = 0.01 * side;
  const double longest = 100.0 * side;
  if (value >= shortest && value <= longest) return;
  place.fail(fmt::format("expected a focal length from {} to {} pixels, got {}", shortest, longest,
                         value));
}

void check_principal_point(double value, int side, const Config& place) {
  // Pictures may be cut out of larger ones, but not from just anywhere.
  if (value >= -side && value <= 2 * side) return;
  place.fail(fmt::format("expected a principal point near the picture, from {} to {}, got {}",
                         -side, 2 * side, value));
}

void check_intrinsics(const Intrinsics& intrinsics, const Config& place) {
  check_integer(intrinsics.width, min_image_side, max_image_side, place.find("width"));
  check_integer(intrinsics.height, min_image_side, max_image_side, place.find("height"));
  const Config matrix = place.find("camera_matrix");
  check_focal_length(intrinsics.fx, intrinsics.width, item_of(matrix, 0));
  check_focal_length(intrinsics.fy, intrinsics.height, item_of(matrix, 1));
  check_principal_point(intrinsics.cx, intrinsics.width, item_of(matrix, 2));
  check_principal_point(intrinsics.cy, intrinsics.height, item_of(matrix, 3));
  for (std::size_t i = 0; i < intrinsics.distortion.size(); ++i) {
    if (std::isfinite(intrinsics.distortion[i])) continue;
    item_of(place.find("distortion"), i)
        .fail(fmt::format("expected a number, got '{}'", intrinsics.distortion[i]));
  }
  if (intrinsics.lens_model == LensModel::fisheye && !Lens(intrinsics).covers_picture()) {
    place.find("distortion")
        .fail(
            "expected a fisheye lens whose picture, corners included, ends less than 85 degrees "
            "off the axis");
  }
}

/// A name is a folder's name and the beginning of its lists' names; in scene.yaml it is a key.
void check_camera_name(const std::string& name, const Config& place) {
  const bool separates = name.find_first_of("/\\:") != std::string::npos;
  if (name.empty() || name.size() > 64 || name.front() == '.' || separates ||
      printable(name) != name) {
    place.fail("expected a name that a folder can have, got '" + printable(name) + "'");
  }
  for (const char* reserved : {"color", "name", "detector"}) {
    if (name == reserved) place.fail("expected another name than '" + name + "'");
  }
}

void check_rgbd_camera(const RgbdCamera& camera, const Config& place) {
  check_camera_name(camera.name, place.find("name"));
  check_intrinsics(camera.color, place.find("color"));
  if (camera.measures_depth) check_intrinsics(camera.depth, place.find("depth"));
  if (!(camera.nearest_m > 0 && camera.farthest_m > camera.nearest_m)) {
    place.find("range_m").fail("expected the nearest and the farthest distance of surfaces");
  }
  const Config unit = place.find("depth_unit_m");
  check_positive(camera.depth_unit_m, unit);
  if (camera.depth_unit_m > 1) unit.fail("expected at most 1 metre");
  check_rigid_transform(camera.color_from_depth, place.find("color_from_depth"));
}

void check_occluder(const OccluderSpec& spec, const Rig* rig, const Config& place) {
  using Detectors = Registry<OccluderDetector>;
  if (spec.name.empty()) place.find("name").fail("expected a name, got ''");
  if (!Detectors::contains(spec.detector)) {
    place.find("detector")
        .fail("expected one of " + Detectors::known() + ", got '" + printable(spec.detector) + "'");
  }
  if (!spec.settings) place.fail("expected the settings of the detector " + spec.detector);
  spec.settings->check(place, rig);
}

}  // namespace

Config item_of(const Config& list, std::size_t index) {
  return list.exists() ? list.items().at(index) : list.find(fmt::format("[{}]", index));
}

void check_rigid_transform(const RigidTransform& transform, const Config& place) {
  const Eigen::Matrix3d& matrix = transform.rotation;
  const Eigen::Matrix3d error = matrix * matrix.transpose() - Eigen::Matrix3d::Identity();
  const Config rotation = place.find("rotation");
  if (!(error.cwiseAbs().maxCoeff() <= rotation_tolerance)) {
    rotation.fail("expected a rotation, got a matrix whose rows are not orthonormal");
  }
  if (matrix.determinant() < 0) rotation.fail("expected a rotation, got a reflection");
  if (!(transform.translation.cwiseAbs().maxCoeff() <= largest_coordinate_m)) {
    place.find("translation").fail("expected metres, got more than a kilometre");
  }
}

void check_rig(const Rig& rig, const Config& place) {
  check_intrinsics(rig.color, place.find("color"));
  const Config cameras = place.find("rgbd");
  const std::size_t in_rgbd = cameras.exists() ? cameras.items().size() : 0;
  if (rig.rgbd.size() > max_rgbd_cameras) {
    cameras.fail(fmt::format("expected at most {} RGB-D cameras", max_rgbd_cameras));
  }
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    // Cameras without depth follow, from a list of their own.
    const bool is_listed = k < in_rgbd || !place.exists();
    const Config camera =
        is_listed ? item_of(cameras, k) : item_of(place.find("cameras"), k - in_rgbd);
    check_rgbd_camera(rig.rgbd[k], camera);
    if (find_rgbd_camera(rig, rig.rgbd[k].name) != &rig.rgbd[k]) {
      camera.find("name").fail("there are two RGB-D cameras called '" + rig.rgbd[k].name + "'");
    }
  }
  using Sources = Registry<PoseSource>;
  if (!Sources::contains(rig.pose_source)) {
    place.find("pose").find("source").fail("expected one of " + Sources::known() + ", got '" +
                                           printable(rig.pose_source) + "'");
  }
}

void check_marker(const MarkerSpec& marker, const Config& place) {
  check_integer(marker.id, 0, max_marker_id, place.find("id"));
  check_positive(marker.size_m, place.find("size_m"));
}

void check_scene(const Scene& scene, const Rig* rig, const Config& place) {
  if (scene.world_marker.size_m != 0) check_marker(scene.world_marker, place.find("world_marker"));
  const Config list = place.find("occluders");
  if (scene.occluders.empty()) list.fail("expected at least one occluder");
  for (std::size_t i = 0; i < scene.occluders.size(); ++i) {
    const OccluderSpec& spec = scene.occluders[i];
    const Config item = spec.place.exists() ? spec.place : item_of(list, i);
    check_occluder(spec, rig, item);
    for (std::size_t other = 0; other < i; ++other) {
      if (scene.occluders[other].name != spec.name) continue;
      item.find("name").fail("there are two occluders called '" + printable(spec.name) + "'");
    }
  }
}

void validate(const Rig& rig) {
  check_rig(rig, {});
}

void validate(const Scene& scene) {
  check_scene(scene, nullptr, {});
}

void validate(const Scene& scene, const Rig& rig) {
  check_scene(scene, &rig, {});
}

}  // namespace diminish
