#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace diminish {

/// The summary.json that `diminish run` wrote to a folder. Throws Error that names the file.
nlohmann::json read_run_summary(const std::filesystem::path& run);

}  // namespace diminish
