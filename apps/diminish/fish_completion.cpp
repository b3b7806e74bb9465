#include "completion.h"
#include "core/text.h"

namespace diminish {
namespace {

std::string fish_string(const std::string& plain) {
  std::string result = "'";
  for (const char letter : plain) {
    if (letter == '\'' || letter == '\\') result += '\\';
    result += letter == '\n' ? ' ' : letter;
  }
  return result + "'";
}

/// Where the words of `command` are on the line and, of those below it, none is.
std::string condition(const CommandTree& command) {
  std::string below;
  for (const CommandTree& child : command.commands) below += " " + child.name;
  std::string result;
  std::size_t start = command.path.find(' ');
  while (start != std::string::npos) {
    const std::size_t end = command.path.find(' ', start + 1);
    result += (result.empty() ? "" : "; and ") + std::string("__fish_seen_subcommand_from ") +
              command.path.substr(start + 1, end - start - 1);
    start = end;
  }
  if (!below.empty()) {
    result += (result.empty() ? "" : "; and ") + ("not __fish_seen_subcommand_from" + below);
  }
  return fish_string(result);
}

std::string values(const CommandOption& option) {
  switch (option.kind) {
    case ValueKind::choice:
      return " -a " + fish_string(join(option.choices, " "));
    case ValueKind::file:
      return " -F";
    case ValueKind::folder:
      return " -a '(__fish_complete_directories)'";
    case ValueKind::text:
      break;
  }
  return "";
}

std::string line(const std::string& where, const CommandOption& option) {
  const std::string start = "complete -c diminish -n " + where;
  if (option.is_argument()) {
    return option.kind == ValueKind::text ? "" : start + values(option) + "\n";
  }
  std::string names;
  for (const std::string& name : option.names) {
    const bool is_long = name.rfind("--", 0) == 0;
    names += is_long ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  const std::string value = option.is_switch() ? "" : " -r" + values(option);
  return start + names + value + " -d " + fish_string(option.help) + "\n";
}

}  // namespace

std::string fish_completion(const CommandTree& program) {
  std::string result =
      "# fish completion for diminish, made by `diminish help --completion fish`\n"
      "complete -c diminish -f\n";
  for_each_command(program, [&](const CommandTree& command) {
    const std::string where = condition(command);
    for (const CommandTree& below : command.commands) {
      result += "complete -c diminish -n " + where + " -a " + below.name + " -d " +
                fish_string(below.help) + "\n";
    }
    for (const CommandOption& option : command.options) result += line(where, option);
  });
  return result;
}

}  // namespace diminish
