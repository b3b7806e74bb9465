#include "setup/calibrate/rig_file.h"

#include <fmt/format.h>

#include "core/text.h"
#include "core/yaml_tree.h"
#include "diminish/error.h"
#include "setup/calibrate/yaml_edit.h"
#include "sink/partial_file.h"
#include "source/rig_yaml.h"

namespace diminish {
namespace {

/// An RGB-D camera's name and its sensor, "color" or "depth".
std::pair<std::string, std::string> split_name(const std::string& camera) {
  const std::size_t bar = camera.rfind('_');
  if (bar == std::string::npos || bar == 0) return {"", ""};
  return {camera.substr(0, bar), camera.substr(bar + 1)};
}

}  // namespace

void expect_camera_name(const std::string& camera) {
  if (camera == "color") return;
  const auto [name, sensor] = split_name(camera);
  if (!name.empty() && (sensor == "color" || sensor == "depth")) return;
  throw Error(
      "--camera: expected color, or an RGB-D camera's sensor such as rgbd0_color or "
      "rgbd0_depth, got '" +
      printable(camera) + "'");
}

RigFile::RigFile(std::filesystem::path file, const std::filesystem::path& start)
    : file_(std::move(file)) {
  std::error_code ignored;
  const bool exists = std::filesystem::exists(file_, ignored);
  if (!exists && !std::filesystem::exists(start, ignored)) return;
  constexpr std::size_t max_bytes = 1 << 20;
  text_ = read_text_file(exists ? file_ : start, max_bytes);
  if (!text_.empty()) yaml_has(text_, {}, file_);
}

void RigFile::set_intrinsics(const std::string& camera, const Intrinsics& intrinsics) {
  expect_camera_name(camera);
  std::vector<YamlStep> place = {key("color")};
  if (camera != "color") {
    const auto [name, sensor] = split_name(camera);
    place = {key("rgbd"), named_item(name), key(sensor)};
  }
  text_ = set_yaml(text_, place, as_yaml(intrinsics), file_);
}

void RigFile::set_color_from_depth(const std::string& rgbd,
                                   const RigidTransform& color_from_depth) {
  text_ = set_yaml(text_, {key("rgbd"), named_item(rgbd), key("color_from_depth")},
                   as_yaml(color_from_depth), file_);
}

void RigFile::set_fixed_poses(
    const std::vector<std::pair<std::string, RigidTransform>>& color_from_rgbd) {
  // Settings of other sources would be errors now.
  if (yaml_has(text_, {key("pose")}, file_)) {
    std::string all;
    for (const auto& [name, transform] : color_from_rgbd) {
      all += (all.empty() ? "" : ", ") + name + ": " + as_yaml(transform);
    }
    text_ =
        set_yaml(text_, {key("pose")}, "{source: fixed, color_from_rgbd: {" + all + "}}", file_);
    return;
  }
  text_ = set_yaml(text_, {key("pose"), key("source")}, "fixed", file_);
  for (const auto& [name, transform] : color_from_rgbd) {
    text_ = set_yaml(text_, {key("pose"), key("color_from_rgbd"), key(name)}, as_yaml(transform),
                     file_);
  }
}

void RigFile::write() const {
  write_file(file_, text_);
}

}  // namespace diminish
