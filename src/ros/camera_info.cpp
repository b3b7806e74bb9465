#include "ros/camera_info.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "diminish/error.h"
#include "ros/pixel_encodings.h"

namespace diminish::ros {
namespace {

void refuse(const std::string& what) {
  throw Error(Error::input, "camera_info: " + what);
}

void set_distortion(const CameraInfoMessage& info, Intrinsics& camera) {
  const bool has_none = std::all_of(info.d.begin(), info.d.end(), [](double d) { return d == 0; });
  if (has_none && info.distortion_model != "equidistant") return;
  const auto model = find_lens_model(info.distortion_model);
  if (!model) {
    refuse(
        fmt::format("expected the distortion_model plumb_bob, rational_polynomial or "
                    "equidistant, got '{}'",
                    printable(info.distortion_model)));
  }
  camera.lens_model = *model;
  const std::size_t known = coefficient_count(*model);
  for (std::size_t i = 0; i < info.d.size(); ++i) {
    if (i < known) {
      camera.distortion[i] = info.d[i];
    } else if (info.d[i] != 0) {
      refuse(fmt::format("expected {} coefficients of {}, got {}", known,
                         printable(info.distortion_model), info.d.size()));
    }
  }
}

}  // namespace

Intrinsics intrinsics_of(const CameraInfoMessage& info, bool is_rectified) {
  Intrinsics camera;
  // The projection's first three columns are a camera matrix, too.
  const bool is_projection = is_rectified && info.p[0] > 0;
  camera.fx = is_projection ? info.p[0] : info.k[0];
  camera.cx = is_projection ? info.p[2] : info.k[2];
  camera.fy = is_projection ? info.p[5] : info.k[4];
  camera.cy = is_projection ? info.p[6] : info.k[5];
  std::uint32_t width = info.width;
  std::uint32_t height = info.height;
  if (info.roi_width > 0 && info.roi_height > 0) {
    width = info.roi_width;
    height = info.roi_height;
    camera.cx -= info.roi_x;
    camera.cy -= info.roi_y;
  }
  const std::uint32_t across = std::max(1U, info.binning_x);
  const std::uint32_t down = std::max(1U, info.binning_y);
  expect_camera_size(width / across, height / down);
  camera.width = static_cast<int>(width / across);
  camera.height = static_cast<int>(height / down);
  camera.fx /= across;
  camera.cx /= across;
  camera.fy /= down;
  camera.cy /= down;
  if (!(camera.fx > 0) || !(camera.fy > 0)) {
    refuse(
        fmt::format("expected focal lengths above 0, got {:g} and {:g}: the camera is not "
                    "calibrated",
                    camera.fx, camera.fy));
  }
  if (!is_rectified) set_distortion(info, camera);
  return camera;
}

CameraInfoMessage camera_info(const Intrinsics& camera) {
  CameraInfoMessage info;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  switch (camera.lens_model) {
    case LensModel::plumb_bob:
      info.distortion_model = "plumb_bob";
      break;
    case LensModel::rational:
      info.distortion_model = "rational_polynomial";
      break;
    case LensModel::fisheye:
      info.distortion_model = "equidistant";
      break;
  }
  info.d.assign(camera.distortion.begin(),
                camera.distortion.begin() +
                    static_cast<std::ptrdiff_t>(coefficient_count(camera.lens_model)));
  info.k = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace diminish::ros
