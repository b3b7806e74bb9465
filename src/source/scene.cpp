#include "diminish/scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "diminish/objects_of_detector.h"
#include "diminish/occluder_detector.h"
#include "source/configuration_checks.h"

namespace diminish {
namespace {

OccluderSpec read_occluder(const Config& config) {
  using Detectors = Registry<OccluderDetector>;
  OccluderSpec spec{config.at("name").text(), config.at("detector").text(), nullptr, config};
  // An unknown one is complained of with all else that is wrong.
  if (Detectors::contains(spec.detector))
    spec.settings = Detectors::get(spec.detector).read(config);
  return spec;
}

/// A plane's end. Four corners, say, lie on it to a hundredth of its size.
void read_corners(const Config& place, GivenPlane& plane) {
  constexpr std::size_t most_corners = 8;
  for (const Config& item : place.items()) plane.corners.push_back(item.vector3());
  const std::size_t count = plane.corners.size();
  if (count < 3 || count > most_corners) place.fail("expected 3 to 8 corners");
  const std::vector<Eigen::Vector3d>& corners = plane.corners;
  plane.point = corners[0];
  plane.normal.setZero();
  double size_m = 0;
  for (std::size_t i = 1; i + 1 < count; ++i) {
    plane.normal += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
    size_m = std::max(size_m, (corners[i] - corners[0]).norm());
  }
  constexpr double least_area_m2 = 1e-6;
  if (!(plane.normal.norm() > least_area_m2))
    place.fail("expected corners in their order around the part, not on one line");
  plane.normal.normalize();
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(plane.normal.dot(corners[i] - plane.point)) > 0.01 * size_m) {
      place.fail("expected corners of one plane");
    }
    const Eigen::Vector3d along = corners[(i + 1) % count] - corners[i];
    const Eigen::Vector3d next = corners[(i + 2) % count] - corners[(i + 1) % count];
    if (!(along.cross(next).dot(plane.normal) >= 0)) {
      place.fail("expected corners in order around a convex part");
    }
  }
}

GivenPlane read_plane(const Config& config) {
  config.expect_keys({"point", "normal", "corners", "marker", "features"});
  GivenPlane plane;
  const Config marker = config.find("marker");
  const Config features = config.find("features");
  const Config corners = config.find("corners");
  if (marker.exists()) {
    config.expect_keys({"marker"});
    plane.from = GivenPlane::From::marker;
    plane.marker = read_marker(marker);
  } else if (features.exists()) {
    config.expect_keys({"features"});
    constexpr int most_planes = 8;
    plane.from = GivenPlane::From::features;
    plane.count = features.integer(1, most_planes);
  } else if (corners.exists()) {
    config.expect_keys({"corners"});
    read_corners(corners, plane);
  } else {
    plane.point = config.at("point").vector3();
    plane.normal = config.at("normal").vector3();
    constexpr double least_length = 1e-6;
    if (!(plane.normal.norm() > least_length)) {
      config.at("normal").fail("expected a direction, got a vector without length");
    }
    plane.normal.normalize();
  }
  return plane;
}

}  // namespace

MarkerSpec read_marker(const Config& config) {
  config.expect_keys({"id", "size_m"});
  return {config.at("id").integer(0, max_marker_id), config.at("size_m").positive_number()};
}

Scene load_scene(const std::filesystem::path& file) {
  return read_scene(Config::load(file));
}

Scene read_scene(const Config& config) {
  config.expect_keys({"marker_dictionary", "world_marker", "occluders", "planes"});
  Scene scene;
  const Config dictionary = config.find("marker_dictionary");
  if (dictionary.exists()) scene.marker_dictionary = dictionary.text();
  const Config world_marker = config.find("world_marker");
  if (world_marker.exists()) scene.world_marker = read_marker(world_marker);
  for (const Config& item : config.at("occluders").items()) {
    scene.occluders.push_back(read_occluder(item));
  }
  const Config planes = config.find("planes");
  if (planes.exists()) {
    for (const Config& item : planes.items()) scene.planes.push_back(read_plane(item));
  }
  check_scene(scene, nullptr, config);
  return scene;
}

std::vector<OccluderSpec> objects_of_detector(const std::string& detector,
                                              const std::string& source) {
  return read_scene(Config::parse(
                        "occluders:\n  - name: object\n    detector: \"" + detector + "\"", source))
      .occluders;
}

}  // namespace diminish
