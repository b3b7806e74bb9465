#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "diminish/options.h"
#include "diminish/scan.h"

namespace diminish {

/// --background, of all commands that show something. It switches the memory on.
class Background {
 public:
  void add_flag(CLI::App& command, Options& options);

  /// Null without the flag. Throws Error.
  std::shared_ptr<const Scan> load() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace diminish
