#include "source/mask_folders.h"

#include <system_error>

#include "diminish/error.h"
#include "source/image_file.h"

namespace diminish {
namespace {

void expect_folder(const Config& config) {
  std::error_code ignored;
  if (std::filesystem::is_directory(config.path(), ignored)) return;
  config.fail("expected a folder, got '" + config.text() + "'");
}

void read_or_report(const std::filesystem::path& file, const Intrinsics& camera, Mask& mask,
                    std::vector<std::string>& faults) {
  try {
    read_mask(file, camera, mask);
  } catch (const Error& error) {
    mask.resize(0, 0);
    faults.push_back(file.string() + ": " + error.what());
  }
}

}  // namespace

MaskFolders parse_mask_folders(const OccluderSpec& spec, const Rig& rig) {
  std::vector<std::string> known = {"name", "detector", "color"};
  for (const RgbdCamera& camera : rig.rgbd) known.push_back(camera.name);
  spec.config.expect_keys(known);
  MaskFolders folders{spec.name, spec.config.at("color").path(), {}};
  for (const RgbdCamera& camera : rig.rgbd) {
    const Config folder = spec.config.find(camera.name);
    folders.rgbd.push_back(folder.exists() ? folder.path() : std::filesystem::path());
  }
  return folders;
}

std::vector<MaskFolders> find_mask_folders(const Scene& scene, const Rig& rig) {
  std::vector<MaskFolders> all;
  for (const OccluderSpec& spec : scene.occluders) {
    if (spec.detector != "mask") continue;
    all.push_back(parse_mask_folders(spec, rig));
    expect_folder(spec.config.at("color"));
    for (const RgbdCamera& camera : rig.rgbd) {
      const Config folder = spec.config.find(camera.name);
      if (folder.exists()) expect_folder(folder);
    }
  }
  return all;
}

void read_given_mask(const MaskFolders& folders, const Rig& rig,
                     const std::vector<std::string>& rgbd_names, FrameSet& frame, GivenMask& mask) {
  mask.occluder = folders.occluder;
  read_or_report(folders.color / (frame.name + ".png"), rig.color, mask.color, frame.faults);
  mask.rgbd.resize(rig.rgbd.size());
  for (std::size_t i = 0; i < rig.rgbd.size(); ++i) {
    mask.rgbd[i].resize(0, 0);
    if (folders.rgbd[i].empty() || rgbd_names[i].empty()) continue;
    std::filesystem::path file = folders.rgbd[i] / (rgbd_names[i] + ".png");
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) file = folders.rgbd[i] / (frame.name + ".png");
    read_or_report(file, rig.rgbd[i].color, mask.rgbd[i], frame.faults);
  }
}

}  // namespace diminish
