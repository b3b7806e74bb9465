#pragma once

#include <CLI/CLI.hpp>

/// Each adds one subcommand, which sets `exit_code` when it runs. What cannot be used throws
/// diminish::Error.
void add_train_color(CLI::App& program, int& exit_code);
