#include "diminish/rig.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "geometry/shrunk_camera.h"
#include "source/configuration_checks.h"
#include "source/find_camera.h"
#include "source/read_rigid_transform.h"

namespace diminish {
namespace {

LensModel read_lens_model(const Config& config) {
  if (!config.exists()) return LensModel::plumb_bob;
  const auto model = find_lens_model(config.text());
  if (!model) {
    config.fail("expected plumb_bob, rational or fisheye, got '" + printable(config.text()) + "'");
  }
  return *model;
}

void read_distortion(const Config& config, Intrinsics& intrinsics) {
  const std::size_t count = coefficient_count(intrinsics.lens_model);
  const std::size_t given = config.items().size();
  if (given != count) {
    config.fail(fmt::format("expected the {} numbers of a {} lens, got {}", count,
                            name_of(intrinsics.lens_model), given));
  }
  const std::vector<double> numbers = config.numbers(count);
  std::copy(numbers.begin(), numbers.end(), intrinsics.distortion.begin());
}

Intrinsics read_intrinsics(const Config& config) {
  config.expect_keys({"width", "height", "camera_matrix", "distortion_model", "distortion"});
  Intrinsics intrinsics;
  intrinsics.width = config.at("width").integer(min_image_side, max_image_side);
  intrinsics.height = config.at("height").integer(min_image_side, max_image_side);
  const std::vector<double> k = config.at("camera_matrix").numbers(4);
  intrinsics.fx = k[0];
  intrinsics.fy = k[1];
  intrinsics.cx = k[2];
  intrinsics.cy = k[3];
  intrinsics.lens_model = read_lens_model(config.find("distortion_model"));
  read_distortion(config.at("distortion"), intrinsics);
  return intrinsics;
}

RgbdCamera read_rgbd_camera(const Config& config) {
  config.expect_keys({"name", "color", "depth", "depth_unit_m", "color_from_depth"});
  RgbdCamera camera;
  camera.name = config.at("name").text();
  camera.color = read_intrinsics(config.at("color"));
  camera.depth = read_intrinsics(config.at("depth"));
  camera.depth_unit_m = config.at("depth_unit_m").positive_number();
  camera.color_from_depth = read_rigid_transform(config.at("color_from_depth"));
  return camera;
}

/// An item of `cameras`.
RgbdCamera read_color_only_camera(const Config& config) {
  config.expect_keys({"name", "color", "range_m"});
  RgbdCamera camera =
      color_only_camera(config.at("name").text(), read_intrinsics(config.at("color")));
  const Config range = config.find("range_m");
  if (range.exists()) {
    const std::vector<double> ends = range.numbers(2);
    if (!(ends[0] > 0 && ends[1] > ends[0])) {
      range.fail("expected the nearest and the farthest distance of surfaces, in metres");
    }
    camera.nearest_m = ends[0];
    camera.farthest_m = ends[1];
  }
  return camera;
}

LiveCamera read_live_camera(const Config& config, const Rig& rig) {
  config.expect_keys({"camera", "uri"});
  LiveCamera camera{config.at("camera").text(), config.at("uri").text()};
  if (camera.name != "color" && find_rgbd_camera(rig, camera.name) == nullptr) {
    std::vector<std::string> known = {"color"};
    for (const RgbdCamera& rgbd : rig.rgbd) known.push_back(rgbd.name);
    config.at("camera").fail("expected one of " + join(known) + ", got '" + printable(camera.name) +
                             "'");
  }
  return camera;
}

}  // namespace

RgbdCamera color_only_camera(const std::string& name, const Intrinsics& color) {
  // Finer than this, an estimate costs time and gains nothing.
  constexpr int most_columns = 960;
  RgbdCamera camera;
  camera.name = name;
  camera.color = color;
  camera.depth = shrunk_camera(color, std::max(1, (color.width + most_columns - 1) / most_columns));
  camera.depth.lens_model = LensModel::plumb_bob;
  camera.depth.distortion = {};
  camera.depth_unit_m = 0.0005;
  camera.measures_depth = false;
  return camera;
}

Rig without_depth(Rig rig) {
  for (RgbdCamera& camera : rig.rgbd) {
    if (!camera.measures_depth) continue;
    RgbdCamera without = color_only_camera(camera.name, camera.color);
    without.depth_from_posed = camera.color_from_depth;
    camera = without;
  }
  return rig;
}

Rig load_rig(const std::filesystem::path& file) {
  return read_rig(Config::load(file));
}

Rig read_rig(const Config& config) {
  config.expect_keys({"live", "color", "rgbd", "cameras", "pose"});
  Rig rig;
  rig.color = read_intrinsics(config.at("color"));
  const Config color_only = config.find("cameras");
  const Config rgbd = color_only.exists() ? config.find("rgbd") : config.at("rgbd");
  if (rgbd.exists()) {
    for (const Config& item : rgbd.items()) rig.rgbd.push_back(read_rgbd_camera(item));
  }
  if (color_only.exists()) {
    for (const Config& item : color_only.items()) {
      rig.rgbd.push_back(read_color_only_camera(item));
    }
  }
  rig.pose = config.find("pose");
  const Config source = rig.pose.find("source");
  if (source.exists()) rig.pose_source = source.text();
  const Config live = config.find("live");
  if (live.exists()) {
    for (const Config& item : live.items()) rig.live.push_back(read_live_camera(item, rig));
    // The first camera of a session is the user's view.
    std::stable_partition(rig.live.begin(), rig.live.end(),
                          [](const LiveCamera& camera) { return camera.name == "color"; });
  }
  check_rig(rig, config);
  return rig;
}

}  // namespace diminish
