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

}  // namespace diminish
