#pragma once

#include <string>

#include "command_tree.h"

namespace diminish {

/// Scripts that make a shell complete the program's commands, options, methods and files.
std::string bash_completion(const CommandTree& program);
std::string zsh_completion(const CommandTree& program);
std::string fish_completion(const CommandTree& program);

}  // namespace diminish
