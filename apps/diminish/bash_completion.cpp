#include <fmt/format.h>

#include <map>

#include "completion.h"
#include "core/text.h"

namespace diminish {
namespace {

constexpr const char* head =
    R"(# bash completion for diminish, made by `diminish help --completion bash`
_diminish() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} command=diminish i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$command ${COMP_WORDS[i]}" in
)";
constexpr const char* after_commands = R"() command+=" ${COMP_WORDS[i]}" ;;
    esac
  done
  # --option=value is three words.
  if [[ $cur == = ]]; then
    cur=
  elif [[ $prev == = ]]; then
    prev=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  case "$command $prev" in
)";
constexpr const char* after_values = R"(  esac
  if [[ $cur == -* ]]; then
    case $command in
)";
constexpr const char* after_options = R"(    esac
    return
  fi
  case $command in
)";
constexpr const char* tail = R"(  esac
}
complete -F _diminish diminish
)";

std::string in_quotes(const std::string& plain) {
  return "'" + plain + "'";
}

std::string words(const std::string& list) {
  return "mapfile -t COMPREPLY < <(compgen -W '" + list + "' -- \"$cur\")";
}

/// What offers the values of an option or argument.
std::string action(const CommandOption& option) {
  switch (option.kind) {
    case ValueKind::choice:
      return words(join(option.choices, " "));
    case ValueKind::file:
      return "compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")";
    case ValueKind::folder:
      return "compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- \"$cur\")";
    case ValueKind::text:
      break;
  }
  return ":";
}

std::string cases(const std::string& indent, const std::map<std::string, std::string>& patterns,
                  const std::string& end) {
  std::string result;
  for (const auto& [what, pattern] : patterns) {
    result += fmt::format("{}{}) {}{} ;;\n", indent, pattern, what, end);
  }
  return result;
}

void add_pattern(std::string& patterns, const std::string& pattern) {
  patterns += (patterns.empty() ? "" : " | ") + in_quotes(pattern);
}

}  // namespace

std::string bash_completion(const CommandTree& program) {
  std::string commands;
  // Commands share most options: the same action is written once.
  std::map<std::string, std::string> values;
  std::map<std::string, std::string> options;
  std::map<std::string, std::string> arguments;
  for_each_command(program, [&](const CommandTree& command) {
    if (&command != &program) add_pattern(commands, command.path);
    std::string names;
    std::string argument = ":";
    for (const CommandOption& option : command.options) {
      if (option.is_argument()) argument = action(option);
      for (const std::string& name : option.names) {
        names += (names.empty() ? "" : " ") + name;
        if (!option.is_switch()) add_pattern(values[action(option)], command.path + " " + name);
      }
    }
    add_pattern(options[words(names)], command.path);
    std::string below;
    for (const CommandTree& child : command.commands) {
      below += (below.empty() ? "" : " ") + child.name;
    }
    add_pattern(arguments[below.empty() ? argument : words(below)], command.path);
  });
  return head + ("      " + commands) + after_commands + cases("    ", values, "; return") +
         after_values + cases("      ", options, "") + after_options +
         cases("    ", arguments, "") + tail;
}

}  // namespace diminish
