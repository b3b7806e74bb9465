#include "diminish/rig.h"

#include <fmt/format.h>

#include "core/text.h"
#include "source/find_camera.h"
#include "source/read_rigid_transform.h"

namespace diminish {
namespace {

constexpr int min_image_side = 8;
constexpr int max_image_side = 16384;
/// A pixel's provenance has this many values for RGB-D cameras.
constexpr std::size_t max_rgbd_cameras = 253;

double read_focal_length(const Config& config, double value, int side) {
  // A field of view between 0.6 and 179 degrees; beyond that it is not in pixels.
  const double shortest = 0.01 * side;
  const double longest = 100.0 * side;
  if (!(value >= shortest && value <= longest)) {
    config.fail(fmt::format("expected a focal length from {} to {} pixels, got {}", shortest,
                            longest, value));
  }
  return value;
}

double read_principal_point(const Config& config, double value, int side) {
  // Pictures may be cut out of larger ones, but not from just anywhere.
  if (!(value >= -side && value <= 2 * side)) {
    config.fail(fmt::format("expected a principal point near the picture, from {} to {}, got {}",
                            -side, 2 * side, value));
  }
  return value;
}

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
  if (intrinsics.lens_model == LensModel::fisheye && !Lens(intrinsics).covers_picture()) {
    config.fail(
        "expected a fisheye lens whose picture, corners included, ends less than 85 "
        "degrees off the axis");
  }
}

Intrinsics read_intrinsics(const Config& config) {
  config.expect_keys({"width", "height", "camera_matrix", "distortion_model", "distortion"});
  Intrinsics intrinsics;
  intrinsics.width = config.at("width").integer(min_image_side, max_image_side);
  intrinsics.height = config.at("height").integer(min_image_side, max_image_side);
  const Config matrix = config.at("camera_matrix");
  const std::vector<double> k = matrix.numbers(4);
  const std::vector<Config> places = matrix.items();
  intrinsics.fx = read_focal_length(places[0], k[0], intrinsics.width);
  intrinsics.fy = read_focal_length(places[1], k[1], intrinsics.height);
  intrinsics.cx = read_principal_point(places[2], k[2], intrinsics.width);
  intrinsics.cy = read_principal_point(places[3], k[3], intrinsics.height);
  intrinsics.lens_model = read_lens_model(config.find("distortion_model"));
  read_distortion(config.at("distortion"), intrinsics);
  return intrinsics;
}

/// A name is a folder's name and the beginning of its lists' names; in scene.yaml it is a key.
std::string read_camera_name(const Config& config) {
  std::string name = config.text();
  const bool separates = name.find_first_of("/\\:") != std::string::npos;
  if (name.empty() || name.size() > 64 || name.front() == '.' || separates ||
      printable(name) != name) {
    config.fail("expected a name that a folder can have, got '" + printable(name) + "'");
  }
  for (const char* reserved : {"color", "name", "detector"}) {
    if (name == reserved) config.fail("expected another name than '" + name + "'");
  }
  return name;
}

RgbdCamera read_rgbd_camera(const Config& config) {
  config.expect_keys({"name", "color", "depth", "depth_unit_m", "color_from_depth"});
  RgbdCamera camera;
  camera.name = read_camera_name(config.at("name"));
  camera.color = read_intrinsics(config.at("color"));
  camera.depth = read_intrinsics(config.at("depth"));
  const Config unit = config.at("depth_unit_m");
  camera.depth_unit_m = unit.positive_number();
  if (camera.depth_unit_m > 1) unit.fail("expected at most 1 metre");
  camera.color_from_depth = read_rigid_transform(config.at("color_from_depth"));
  return camera;
}

}  // namespace

Rig load_rig(const std::filesystem::path& file) {
  return read_rig(Config::load(file));
}

Rig read_rig(const Config& config) {
  config.expect_keys({"color", "rgbd", "pose"});
  Rig rig;
  rig.color = read_intrinsics(config.at("color"));
  const Config cameras = config.at("rgbd");
  for (const Config& item : cameras.items()) {
    RgbdCamera camera = read_rgbd_camera(item);
    if (find_rgbd_camera(rig, camera.name)) {
      item.at("name").fail("there are two RGB-D cameras called '" + camera.name + "'");
    }
    rig.rgbd.push_back(std::move(camera));
  }
  if (rig.rgbd.empty()) cameras.fail("expected at least one RGB-D camera");
  if (rig.rgbd.size() > max_rgbd_cameras) {
    cameras.fail(fmt::format("expected at most {} RGB-D cameras", max_rgbd_cameras));
  }
  rig.pose = config.find("pose");
  const Config source = rig.pose.find("source");
  if (source.exists()) rig.pose_source = source.text();
  return rig;
}

}  // namespace diminish
