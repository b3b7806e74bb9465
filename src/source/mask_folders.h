#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// Where the masks of an occluder are that another program made (the detector `mask`).
struct MaskFolders {
  std::string occluder;
  std::filesystem::path color;
  std::vector<std::filesystem::path> rgbd;  ///< one per RGB-D camera; empty where there are none
};

/// The folders of all occluders in the scene that have such masks. Throws Error if a folder does
/// not exist.
std::vector<MaskFolders> find_mask_folders(const Scene& scene, const Rig& rig);

/// Reads one frame's masks, FOLDER/NAME.png. NAME is the frame's name, or for an RGB-D camera
/// preferably its own colour image's from `rgbd_names` (empty: no image in this frame). Unusable
/// masks are left empty and become faults of the frame.
void read_given_mask(const MaskFolders& folders, const Rig& rig,
                     const std::vector<std::string>& rgbd_names, FrameSet& frame, GivenMask& mask);

}  // namespace diminish
