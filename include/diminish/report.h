#pragma once

#include <filesystem>

#include "diminish/export.h"

namespace diminish {

/// Writes one HTML page about the results in `run` (from `diminish run`) on `recording`, which has
/// truth/: a slider between input, result and truth, plots of every figure over the frames, the
/// paper's Table 2, and where the pixels come from. The page needs no other file and no network.
/// Throws Error if either folder lacks something.
DIMINISH_EXPORT void write_report(const std::filesystem::path& recording,
                                  const std::filesystem::path& run,
                                  const std::filesystem::path& file);

/// Writes one HTML page about two runs on the same recording, which has truth/: figures side by
/// side, the options that differ, and the frames whose results differ most, with a slider between
/// them. most_frames: with pictures. Throws Error if a folder lacks something.
DIMINISH_EXPORT void write_comparison(const std::filesystem::path& recording,
                                      const std::filesystem::path& first,
                                      const std::filesystem::path& second,
                                      const std::filesystem::path& file, int most_frames = 8);

}  // namespace diminish
