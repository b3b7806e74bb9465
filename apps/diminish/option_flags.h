#pragma once

#include <CLI/CLI.hpp>

#include "diminish/options.h"

namespace diminish {

/// Adds a flag for every option; its help shows unit and default.
void add_option_flags(CLI::App& command, Options& options);

}  // namespace diminish
