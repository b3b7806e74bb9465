#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace diminish {

/// What a shell offers where a value is expected.
enum class ValueKind { text, choice, file, folder };

/// An option or an argument of a command, as its definition says.
struct CommandOption {
  std::vector<std::string> names;  ///< "-h", "--help", "--no-refine-poses"; empty for arguments
  std::string value;  ///< "FOLDER", "pixels"; of arguments their name; empty for switches
  ValueKind kind = ValueKind::text;
  std::vector<std::string> choices;  ///< of kind choice
  std::string range;                 ///< "1 to 1024"; empty: none
  std::string fallback;              ///< the default, as text
  std::string help;
  std::string group;
  bool required = false;
  bool repeated = false;

  bool is_argument() const { return names.empty(); }
  bool is_switch() const { return !is_argument() && value.empty(); }
};

/// A command with those below it. Man pages and completion are made from nothing else, so that they
/// cannot say anything that `--help` does not.
struct CommandTree {
  std::string path;  ///< "diminish calibrate rig"
  std::string name;  ///< "rig"
  std::string help;
  std::string footer;
  std::vector<CommandOption> options;  ///< in the order of their definition
  std::vector<CommandTree> commands;
};

/// Reads it off the definition. path: of the command.
CommandTree command_tree(const CLI::App& command, const std::string& path);

/// Calls visit(command) for the tree's root and everything below, parents first.
template <class Visit>
void for_each_command(const CommandTree& tree, const Visit& visit) {
  visit(tree);
  for (const CommandTree& command : tree.commands) for_each_command(command, visit);
}

}  // namespace diminish
