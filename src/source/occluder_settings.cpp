#include "diminish/occluder_settings.h"

#include <fmt/format.h>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "core/limits.h"
#include "core/text.h"
#include "source/configuration_checks.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

void check_point(const Eigen::Vector3d& point_m, const Config& place) {
  if (!point_m.allFinite()) place.fail("expected three numbers");
  if (point_m.cwiseAbs().maxCoeff() > largest_coordinate_m) {
    place.fail("expected metres, got more than a kilometre");
  }
}

void check_vertices(const std::vector<Eigen::Vector3d>& vertices, const Config& place) {
  if (vertices.size() < 4) place.fail("expected at least 4 points");
  Eigen::Matrix3Xd edges(3, vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    check_point(vertices[i], item_of(place, i));
    edges.col(static_cast<Eigen::Index>(i)) = vertices[i] - vertices[0];
  }
  if (edges.colPivHouseholderQr().rank() < 2) {
    place.fail("expected points that are not all on one line");
  }
}

void check_triangles(const MarkerSettings& settings, const Config& place) {
  const auto is_vertex = [&](int index) {
    return index >= 0 && static_cast<std::size_t>(index) < settings.vertices.size();
  };
  for (const std::array<int, 3>& corners : settings.triangles) {
    if (std::all_of(corners.begin(), corners.end(), is_vertex)) continue;
    place.fail("expected indices of the vertices");
  }
}

/// Estimates come too late: they are made where objects are known.
void check_measured_depth(const std::string& detector, const Config& place, const Rig* rig) {
  if (rig == nullptr) return;
  const bool any = std::any_of(rig->rgbd.begin(), rig->rgbd.end(),
                               [](const RgbdCamera& camera) { return camera.measures_depth; });
  if (any) return;
  place.find("detector").fail(detector + " needs a camera that measures depth (rgbd) in rig.yaml");
}

}  // namespace

void MarkerSettings::check(const Config& place, const Rig*) const {
  check_marker(marker, place.find("marker"));
  if (vertices.empty() == mesh.empty()) place.fail("expected either vertices or mesh");
  if (mesh.empty()) check_vertices(vertices, place.find("vertices"));
  check_triangles(*this, place.find("triangles"));
}

std::vector<std::filesystem::path> MarkerSettings::files() const {
  if (mesh.empty()) return {};
  return {mesh};
}

void ColorBlobSettings::check(const Config& place, const Rig*) const {
  if (training.empty()) place.find("training").fail("expected a path, got ''");
}

void MaskSettings::check(const Config& place, const Rig* rig) const {
  if (rig == nullptr) return;
  for (const auto& [name, folder] : rgbd) {
    if (find_rgbd_camera(*rig, name) != nullptr) continue;
    std::vector<std::string> known = {"name", "detector", "color"};
    for (const RgbdCamera& camera : rig->rgbd) known.push_back(camera.name);
    place.find(name).fail("unknown key, expected one of " + join(known));
  }
}

void BoxSettings::check(const Config& place, const Rig* rig) const {
  check_point(min_m, place.find("min"));
  check_point(max_m, place.find("max"));
  if ((min_m.array() >= max_m.array()).any()) {
    place.find("max").fail("expected three numbers, each above min's");
  }
  check_measured_depth("box", place, rig);
  if (rig == nullptr || frame == "world" || find_rgbd_camera(*rig, frame) != nullptr) return;
  std::vector<std::string> known = {"world"};
  for (const RgbdCamera& camera : rig->rgbd) known.push_back(camera.name);
  place.find("frame").fail("expected one of " + join(known) + ", got '" + printable(frame) + "'");
}

void OnnxSettings::check(const Config& place, const Rig*) const {
  constexpr int least_side = 16;
  constexpr int greatest_side = 4096;
  for (const int side : {width, height}) {
    if (side < least_side || side > greatest_side) {
      place.find("size").fail("expected the width and height of the network's input, 16 to 4096");
    }
  }
  if (!(std::isfinite(scale) && scale > 0)) place.find("scale").fail("expected a number above 0");
  if (!mean.allFinite()) place.find("mean").fail("expected three numbers");
  if (classes.empty() || *std::min_element(classes.begin(), classes.end()) < 0) {
    place.find("classes").fail("expected numbers from 0 on");
  }
  if (!std::isfinite(threshold)) place.find("threshold").fail("expected a number");
  if (every < 1 || every > greatest_every) {
    place.find("every").fail(fmt::format("expected a whole number, 1 to {}", greatest_every));
  }
  constexpr double steadiest = 0.9;
  if (!(steady >= 0 && steady <= steadiest)) {
    place.find("steady").fail(fmt::format("expected a number from 0 to {}", steadiest));
  }
}

void ArticulatedSettings::check(const Config& place, const Rig*) const {
  if (chain.empty()) place.find("chain").fail("expected a path, got ''");
  if (angles.empty()) place.find("angles").fail("expected a path, got ''");
  check_rigid_transform(world_from_base, place.find("base"));
  if (!(std::isfinite(tolerance_s) && tolerance_s > 0)) {
    place.find("tolerance_s").fail("expected a number above 0");
  }
}

void DifferenceSettings::check(const Config& place, const Rig* rig) const {
  if (!(clearance >= 0.05 && clearance <= 0.95)) {
    place.find("clearance").fail("expected a number from 0.05 to 0.95");
  }
  check_measured_depth("difference", place, rig);
}

}  // namespace diminish
