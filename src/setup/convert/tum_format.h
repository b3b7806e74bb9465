#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "diminish/intrinsics.h"

namespace diminish {

// The TUM RGB-D benchmark's folders: vision.in.tum.de/data/datasets/rgbd-dataset/file_formats

inline constexpr double tum_unit_m = 1. / 5000;

// Such folders do not tell their lens: camera.txt is ours.
std::string tum_camera_text(const Intrinsics& lens);
/// Of a folder's camera.txt; nothing if there is none. Throws Error that names the file.
std::optional<Intrinsics> read_tum_camera(const std::filesystem::path& folder);

}  // namespace diminish
