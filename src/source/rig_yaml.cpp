#include "source/rig_yaml.h"

#include <fmt/format.h>

namespace diminish {
namespace {

/// The shortest text with the same nine digits.
std::string number(double value) {
  return fmt::format("{:.9g}", value);
}

}  // namespace

std::string as_yaml(const Intrinsics& camera) {
  std::string distortion;
  for (std::size_t i = 0; i < coefficient_count(camera.lens_model); ++i) {
    distortion += (i == 0 ? "" : ", ") + fmt::format("{:.6g}", camera.distortion[i]);
  }
  const bool is_usual = camera.lens_model == LensModel::plumb_bob;
  const std::string model =
      is_usual ? "" : fmt::format("distortion_model: {}, ", name_of(camera.lens_model));
  return fmt::format(
      "{{width: {}, height: {}, camera_matrix: [{:.3f}, {:.3f}, {:.3f}, {:.3f}], {}distortion: "
      "[{}]}}",
      camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, model, distortion);
}

std::string as_yaml(const RigidTransform& transform) {
  std::string rotation;
  for (int i = 0; i < 9; ++i) {
    rotation += (i == 0 ? "" : ", ") + number(transform.rotation(i / 3, i % 3));
  }
  const Eigen::Vector3d& t = transform.translation;
  return fmt::format("{{rotation: [{}], translation: [{}, {}, {}]}}", rotation, number(t.x()),
                     number(t.y()), number(t.z()));
}

std::string as_yaml(const Rig& rig, const std::string& pose) {
  std::string text = "color: " + as_yaml(rig.color) + "\nrgbd:" + (rig.rgbd.empty() ? " []" : "");
  for (const RgbdCamera& camera : rig.rgbd) {
    text += fmt::format(
        "\n  - name: {}\n    color: {}\n    depth: {}\n    depth_unit_m: {}\n    "
        "color_from_depth: {}",
        camera.name, as_yaml(camera.color), as_yaml(camera.depth), number(camera.depth_unit_m),
        as_yaml(camera.color_from_depth));
  }
  return text + "\npose: " + pose + "\n";
}

}  // namespace diminish
