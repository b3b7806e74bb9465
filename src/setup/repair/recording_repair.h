#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace diminish {

/// What was wrong with a recording's list.
struct ListRepair {
  std::string list;      ///< "rgbd0_depth.txt"
  std::size_t kept = 0;  ///< entries
  /// For each entry that was left out: "line 12: rgbd0/depth/000011.png: the file is cut short".
  std::vector<std::string> left_out;
};

struct RecordingRepair {
  std::vector<ListRepair> lists;
  std::vector<std::filesystem::path> deleted;  ///< begun and never finished

  bool was_needed() const;
};

/// Makes a recording whole that was being written when the program, or the machine, stopped: leaves
/// out of its lists what cannot be read, and deletes files that were begun. A list that is changed
/// is kept beside it, as "rgbd0_depth.txt.before". Looks at every image. Throws Error if rig.yaml
/// or the colour camera's list is missing, or nothing is left of it.
RecordingRepair repair_recording(const std::filesystem::path& folder);

}  // namespace diminish
