#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <system_error>

#include "core/mat.h"
#include "diminish/occluder_settings.h"
#include "diminish/scan.h"
#include "sink/partial_file.h"
#include "sink/pose_line.h"
#include "sink/recording_folder.h"
#include "source/rig_yaml.h"

namespace diminish {
namespace {

/// Writes each camera's list. Returns what rig.yaml has to say of them.
std::string write_poses(const Scan& scan, const std::filesystem::path& folder) {
  std::string files;
  const auto write = [&](const std::string& camera, const auto& pose_of) {
    std::string list = pose_list_head;
    for (const PosedFrame& posed : scan.frames) {
      if (const auto& pose = pose_of(posed)) list += pose_line(posed.frame.stamp_s, *pose);
    }
    write_file(folder / (camera + "_poses.txt"), list);
    files += fmt::format("{}{}: {}_poses.txt", files.empty() ? "" : ", ", camera, camera);
  };
  write("color", [](const PosedFrame& posed) { return posed.poses.color_from_world; });
  for (std::size_t k = 0; k < scan.rig.rgbd.size(); ++k) {
    write(scan.rig.rgbd[k].name,
          [k](const PosedFrame& posed) { return posed.poses.depth_from_world[k]; });
  }
  return "{source: file, files: {" + files + "}}";
}

/// The masks that another program made for the colour camera's pictures. The RGB-D cameras' are
/// empty: the depth images have no objects.
void copy_masks(const Scan& scan, const RecordingFolder& recording) {
  for (const OccluderSpec& spec : scan.scene.occluders) {
    const auto* const settings = dynamic_cast<const MaskSettings*>(spec.settings.get());
    if (!settings) continue;
    for (const PosedFrame& posed : scan.frames) {
      const std::string name = posed.frame.name + ".png";
      std::error_code ignored;
      if (std::filesystem::exists(settings->color / name, ignored)) {
        copy_to(settings->color / name, recording.place_of(settings->color) / name);
      }
    }
    for (const RgbdCamera& camera : scan.rig.rgbd) {
      const auto folder = settings->rgbd.find(camera.name);
      if (folder == settings->rgbd.end()) continue;
      const cv::Mat none(camera.color.height, camera.color.width, CV_8UC1, cv::Scalar(0));
      const std::filesystem::path place = recording.place_of(folder->second);
      std::filesystem::create_directories(place);
      for (const PosedFrame& posed : scan.frames) {
        write_png(place / (posed.frame.name + ".png"), none);
      }
    }
  }
}

}  // namespace

void save_scan(const Scan& scan, const std::filesystem::path& scene_file,
               const std::filesystem::path& folder) {
  RecordingFolder recording(folder, scan.rig, scene_file, scan.scene,
                            RecordingFolder::Pictures::png);
  copy_masks(scan, recording);
  for (const PosedFrame& posed : scan.frames) recording.write(posed.frame, posed.frame.name);
  // Last, so that a folder with it is whole.
  write_file(folder / "rig.yaml", as_yaml(scan.rig, write_poses(scan, folder)));
}

}  // namespace diminish
