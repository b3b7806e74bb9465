#pragma once

#include <filesystem>
#include <string>

namespace diminish::testing {

/// Where the tests' files are on this machine.
std::string recordings_dir();  ///< the bundled recordings
inline const std::filesystem::path recordings = recordings_dir();
std::string docs_dir();
std::string source_test_data();  ///< src/source/test_data
std::string program();           ///< the built command line tool

}  // namespace diminish::testing
