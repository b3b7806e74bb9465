#include <algorithm>

#include "completion.h"
#include "core/text.h"

namespace diminish {
namespace {

/// Inside single quotes and a specification of _arguments.
std::string escaped(const std::string& plain) {
  std::string result;
  for (const char letter : plain) {
    if (letter == '\'') {
      result += "'\\''";
    } else if (letter == '[' || letter == ']' || letter == ':' || letter == '\\') {
      result += std::string("\\") + letter;
    } else {
      result += letter == '\n' ? ' ' : letter;
    }
  }
  return result;
}

std::string zsh_action(const CommandOption& option) {
  switch (option.kind) {
    case ValueKind::choice:
      return "(" + join(option.choices, " ") + ")";
    case ValueKind::file:
      return "_files";
    case ValueKind::folder:
      return "_files -/";
    case ValueKind::text:
      break;
  }
  return " ";
}

std::string function_name(const CommandTree& command) {
  std::string name = "_" + command.path;
  std::replace_if(
      name.begin(), name.end(), [](char letter) { return letter == ' ' || letter == '-'; }, '_');
  return name;
}

/// One line of _arguments for each of the option's names.
std::string specifications(const CommandOption& option, int position) {
  const std::string value = ":" + escaped(option.value) + ":" + zsh_action(option);
  if (option.is_argument()) {
    const std::string where = option.repeated ? "*" : std::to_string(position);
    return "    '" + where + value + "' \\\n";
  }
  std::string result;
  for (const std::string& name : option.names) {
    result += std::string("    '") + (option.repeated ? "*" : "") + name +
              (option.is_switch() ? "" : "=") + "[" + escaped(option.help) + "]" +
              (option.is_switch() ? "" : value) + "' \\\n";
  }
  return result;
}

std::string function(const CommandTree& command) {
  const bool has_commands = !command.commands.empty();
  std::string result = function_name(command) + "() {\n";
  if (has_commands) result += "  local context state state_descr line\n  typeset -A opt_args\n";
  result += "  _arguments -C \\\n";
  int position = 0;
  for (const CommandOption& option : command.options) {
    if (option.is_argument()) ++position;
    result += specifications(option, position);
  }
  if (!has_commands) return result + "    && return 0\n}\n\n";
  result += "    '1: :->command' '*:: :->arguments' && return 0\n  case $state in\n    command)\n";
  result += "      local -a commands=(\n";
  for (const CommandTree& below : command.commands) {
    result += "        '" + below.name + ":" + escaped(below.help) + "'\n";
  }
  result +=
      "      )\n      _describe command commands ;;\n    arguments)\n      case $words[1] in\n";
  for (const CommandTree& below : command.commands) {
    result += "        " + below.name + ") " + function_name(below) + " ;;\n";
  }
  return result + "      esac ;;\n  esac\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandTree& program) {
  std::string result =
      "#compdef diminish\n# zsh completion for diminish, made by `diminish help --completion "
      "zsh`\n\n";
  for_each_command(program, [&](const CommandTree& command) { result += function(command); });
  return result + "_diminish \"$@\"\n";
}

}  // namespace diminish
