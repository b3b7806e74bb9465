#pragma once

#include <filesystem>
#include <vector>

#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// A moment of a recording, with the cameras' poses.
struct PosedFrame {
  FrameSet frame;
  Poses poses;
};

/// A place as it was seen before: what the memory kept of a recording, as a short recording again
/// (docs/memory.md).
struct Scan {
  /// The name of the first RGB-D camera: the colour camera itself, with depth in its own view. That
  /// is 0 where an object to remove was, or where nothing was measured.
  static constexpr const char* camera = "memory";

  /// The colour camera; `camera`; the recording's RGB-D cameras, with some pixels of their depth
  /// images and the colours there; and maybe what these saw behind the objects.
  Rig rig;
  Scene scene;
  std::vector<PosedFrame> frames;
};

/// Reads a folder that `save_scan` wrote. Throws Error that names the file and what is wrong in it;
/// also if a picture or a pose is missing.
DIMINISH_EXPORT Scan load_scan(const std::filesystem::path& folder);

/// Writes a scan as a recording (docs/recording-format.md) with lossless pictures and given poses.
/// scene_file: where its scene comes from. Copies it and what it names. Throws Error if the folder
/// is not empty or a file cannot be written.
DIMINISH_EXPORT void save_scan(const Scan& scan, const std::filesystem::path& scene_file,
                               const std::filesystem::path& folder);

}  // namespace diminish
