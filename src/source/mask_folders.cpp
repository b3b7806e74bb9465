#include "source/mask_folders.h"

#include <system_error>

#include "core/text.h"
#include "diminish/error.h"
#include "diminish/occluder_settings.h"
#include "source/image_file.h"

namespace diminish {
namespace {

void expect_folder(const std::filesystem::path& folder, const Config& place) {
  std::error_code ignored;
  if (std::filesystem::is_directory(folder, ignored)) return;
  place.fail("expected a folder, got '" + printable(folder.string()) + "'");
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

std::vector<MaskFolders> find_mask_folders(const Scene& scene, const Rig& rig) {
  std::vector<MaskFolders> all;
  for (const OccluderSpec& spec : scene.occluders) {
    const auto* const settings = dynamic_cast<const MaskSettings*>(spec.settings.get());
    if (settings == nullptr || settings->color.empty()) continue;
    expect_folder(settings->color, spec.place.find("color"));
    MaskFolders& folders = all.emplace_back(MaskFolders{spec.name, settings->color, {}});
    for (const RgbdCamera& camera : rig.rgbd) {
      const auto given = settings->rgbd.find(camera.name);
      const bool is_given = given != settings->rgbd.end();
      if (is_given) expect_folder(given->second, spec.place.find(camera.name));
      folders.rgbd.push_back(is_given ? given->second : std::filesystem::path());
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
