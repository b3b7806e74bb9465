#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "diminish/diminished_frame.h"
#include "diminish/rig.h"

namespace diminish {

/// Writes frames.csv, one row per frame; every written row is complete. Columns:
/// docs/results.md.
class FramesCsv {
 public:
  FramesCsv(const std::filesystem::path& file, const Rig& rig);
  void append(const DiminishedFrame& frame);

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  std::vector<std::string> cameras_;
};

}  // namespace diminish
