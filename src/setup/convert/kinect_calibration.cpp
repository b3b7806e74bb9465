#include "setup/convert/kinect_calibration.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/limits.h"
#include "diminish/error.h"

namespace diminish {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& expected) {
  throw Error(Error::input, "calibration.json: expected " + expected);
}

const json& member(const json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (!object.is_object() || found == object.end()) fail(key);
  return *found;
}

template <std::size_t count>
std::array<double, count> numbers(const json& list, const char* what) {
  if (!list.is_array() || list.size() < count) fail(fmt::format("{} numbers as {}", count, what));
  std::array<double, count> values;
  for (std::size_t i = 0; i < count; ++i) {
    if (!list[i].is_number()) fail(fmt::format("{} numbers as {}", count, what));
    values[i] = list[i];
    if (!std::isfinite(values[i]) || std::abs(values[i]) > 1e6) {
      fail(fmt::format("usual numbers as {}", what));
    }
  }
  return values;
}

double size(const json& object, const char* key) {
  const json& value = member(object, key);
  if (!value.is_number() || !(value > 0) || !(value < 100'000))
    fail(fmt::format("{} above 0", key));
  return value;
}

/// The entry of a location: CALIBRATION_CameraLocation...
const json& camera_at(const json& cameras, std::string_view location) {
  if (!cameras.is_array()) fail("a list of Cameras");
  const std::string wanted = fmt::format("CALIBRATION_CameraLocation{}", location);
  for (const json& camera : cameras) {
    const json& place = member(camera, "Location");
    if (place.is_string() && place == wanted) return camera;
  }
  fail(fmt::format("a camera at the location {}", location));
}

/// The whole sensor's image as a mode reads it: scaled to `scaled`, then cut out from `corner` on.
struct Mode {
  cv::Size2d scaled;
  cv::Point2d corner;
};

Mode depth_mode(const json& camera, cv::Size image) {
  if (size(camera, "SensorWidth") != 1024 || size(camera, "SensorHeight") != 1024) {
    fail("a depth sensor of 1024x1024");
  }
  if (image == cv::Size(320, 288)) return {{512, 512}, {96, 90}};
  if (image == cv::Size(640, 576)) return {{1024, 1024}, {192, 180}};
  if (image == cv::Size(512, 512) || image == cv::Size(1024, 1024)) return {image, {0, 0}};
  throw Error(Error::input,
              fmt::format("expected depth of 320x288, 640x576, 512x512 or 1024x1024, got {}x{}",
                          image.width, image.height));
}

/// Of a calibration of the 4:3 picture; an early one is of its 16:9 middle.
Mode color_mode(const json& camera, cv::Size image) {
  const double aspect = size(camera, "SensorHeight") / size(camera, "SensorWidth");
  constexpr double tolerance = 1e-3;
  const double full_height = image.width * .75;
  if (std::abs(aspect - 3. / 4) < tolerance) {
    return {{static_cast<double>(image.width), full_height}, {0, (full_height - image.height) / 2}};
  }
  if (std::abs(aspect - 9. / 16) > tolerance) fail("a colour sensor of 4:3 or 16:9");
  const double middle = image.width * 9. / 16;
  return {{static_cast<double>(image.width), middle}, {0, (middle - image.height) / 2}};
}

/// Source: Azure Kinect Sensor SDK, k4atypes.h (the parameters' order) and its documented
/// convention: the whole sensor is 1 wide and high, (0, 0) is the corner of its first pixel.
Intrinsics lens_of(const json& camera, const Mode& mode, cv::Size image) {
  const json& intrinsics = member(camera, "Intrinsics");
  if (member(intrinsics, "ModelType") != "CALIBRATION_LensDistortionModelBrownConrady") {
    fail("the lens model BrownConrady");
  }
  const auto [cx, cy, fx, fy, k1, k2, k3, k4, k5, k6, codx, cody, p2, p1] =
      numbers<14>(member(intrinsics, "ModelParameters"), "ModelParameters");
  if (!(fx > 0 && fy > 0)) fail("focal lengths above 0");
  if (codx != 0 || cody != 0) fail("a lens whose distortion is centred");
  Intrinsics lens;
  lens.width = image.width;
  lens.height = image.height;
  lens.fx = fx * mode.scaled.width;
  lens.fy = fy * mode.scaled.height;
  // Ours has (0, 0) at the first pixel's centre.
  lens.cx = cx * mode.scaled.width - mode.corner.x - 0.5;
  lens.cy = cy * mode.scaled.height - mode.corner.y - 0.5;
  lens.lens_model = LensModel::rational;
  lens.distortion = {k1, k2, p1, p2, k3, k4, k5, k6};
  return lens;
}

/// From the device's frame, which is the depth sensor's in all known devices.
RigidTransform camera_from_device(const json& camera) {
  const json& rt = member(camera, "Rt");
  const auto r = numbers<9>(member(rt, "Rotation"), "Rotation");
  const auto t = numbers<3>(member(rt, "Translation"), "Translation");
  RigidTransform transform;
  transform.rotation << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
  transform.translation = {t[0], t[1], t[2]};
  const Eigen::Matrix3d error =
      transform.rotation * transform.rotation.transpose() - Eigen::Matrix3d::Identity();
  if (error.cwiseAbs().maxCoeff() > 1e-3 || transform.rotation.determinant() < 0) {
    fail("a rotation as Rotation");
  }
  if (transform.translation.cwiseAbs().maxCoeff() > largest_coordinate_m) {
    fail("metres as Translation");
  }
  // Its digits are a float's.
  transform.rotation = Eigen::Quaterniond(transform.rotation).normalized().toRotationMatrix();
  return transform;
}

}  // namespace

KinectCalibration read_kinect_calibration(std::string_view text, cv::Size color, cv::Size depth) {
  const json document = json::parse(text, nullptr, false);
  if (document.is_discarded()) fail("JSON");
  const json& cameras = member(member(document, "CalibrationInformation"), "Cameras");
  const json& depth_camera = camera_at(cameras, "D0");
  const json& color_camera = camera_at(cameras, "PV0");
  KinectCalibration calibration;
  calibration.depth = lens_of(depth_camera, depth_mode(depth_camera, depth), depth);
  calibration.color = lens_of(color_camera, color_mode(color_camera, color), color);
  calibration.color_from_depth =
      camera_from_device(color_camera) * camera_from_device(depth_camera).inverse();
  return calibration;
}

}  // namespace diminish
