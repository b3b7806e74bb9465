#pragma once

#include <string>

#include "command_tree.h"

namespace diminish {

/// The file's name: "diminish-calibrate-rig.1"
std::string man_page_name(const CommandTree& command);

/// The page's source, for man(1).
std::string man_page(const CommandTree& command);

}  // namespace diminish
