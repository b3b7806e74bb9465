#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// Where an occluder's masks are that another program made (the detector `mask`).
struct MaskFolders {
  std::string occluder;
  std::filesystem::path color;
  std::vector<std::filesystem::path> rgbd;  ///< one per RGB-D camera; empty where there are none
};

/// Reads such an occluder's settings. Throws Error, naming file and key. Does not look at the
/// folders.
MaskFolders parse_mask_folders(const OccluderSpec& spec, const Rig& rig);

/// The folders of all occluders of the scene that have such masks. Throws Error also if a folder
/// does not exist.
std::vector<MaskFolders> find_mask_folders(const Scene& scene, const Rig& rig);

/// Reads one frame's masks: FOLDER/NAME.png, NAME being the frame's name; for an RGB-D camera
/// preferably its own colour image's, which `rgbd_names` holds (empty: it has no image in this
/// frame). Masks that cannot be used are left empty, and are the frame's faults.
void read_given_mask(const MaskFolders& folders, const Rig& rig,
                     const std::vector<std::string>& rgbd_names, FrameSet& frame, GivenMask& mask);

}  // namespace diminish
