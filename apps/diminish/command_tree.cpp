#include "command_tree.h"

#include <CLI/CLI.hpp>
#include <string_view>

namespace diminish {
namespace {

/// The words of "{a,b,c}".
std::vector<std::string> words_in_braces(std::string_view text) {
  std::vector<std::string> words;
  const std::size_t open = text.find('{');
  const std::size_t close = text.find('}');
  if (open == std::string_view::npos || close == std::string_view::npos) return words;
  std::string_view rest = text.substr(open + 1, close - open - 1);
  while (true) {
    const std::size_t comma = rest.find(',');
    words.emplace_back(rest.substr(0, comma));
    if (comma == std::string_view::npos) return words;
    rest.remove_prefix(comma + 1);
  }
}

/// "1 to 1024" of "INT in [1 - 1024]"; empty if it is no range.
std::string range_in_brackets(std::string_view text) {
  constexpr std::string_view before = " in [";
  constexpr std::string_view between = " - ";
  const std::size_t open = text.find(before);
  const std::size_t middle = text.find(between, open);
  const std::size_t close = text.find(']', middle);
  if (open == std::string_view::npos || close == std::string_view::npos) return {};
  const std::size_t first = open + before.size();
  const std::size_t second = middle + between.size();
  return std::string(text.substr(first, middle - first)) + " to " +
         std::string(text.substr(second, close - second));
}

ValueKind kind_of(const std::string& type) {
  if (type == "FOLDER") return ValueKind::folder;
  return type == "FILE" || type == "PNG" ? ValueKind::file : ValueKind::text;
}

CommandOption describe(const CLI::Option& option) {
  CommandOption result;
  for (const std::string& name : option.get_snames()) result.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) result.names.push_back("--" + name);
  result.help = option.get_description();
  result.group = option.get_group();
  result.required = option.get_required();
  if (option.get_items_expected_max() == 0) return result;
  result.repeated = option.get_expected_max() == CLI::detail::expected_max_vector_size;
  // "FOLDER", "N:INT in [1 - 1024]", "{cpu,gl}", "TEXT:{plumb_bob,fisheye}"
  const std::string type = option.get_type_name();
  const std::string value = type.substr(0, type.find(':'));
  result.choices = words_in_braces(type);
  result.range = range_in_brackets(type);
  result.kind = result.choices.empty() ? kind_of(value) : ValueKind::choice;
  result.fallback = option.get_default_str();
  if (option.get_positional()) {
    result.value = option.get_name(true);
  } else {
    result.value = value.empty() ? "VALUE" : result.choices.empty() ? value : "METHOD";
  }
  return result;
}

}  // namespace

CommandTree command_tree(const CLI::App& command, const std::string& path) {
  // Commands begin with the footer of the one above.
  const std::string footer = command.get_footer();
  const std::string inherited =
      command.get_parent() == nullptr ? "" : command.get_parent()->get_footer();
  CommandTree tree{.path = path,
                   .name = command.get_name(),
                   .help = command.get_description(),
                   .footer = footer == inherited ? "" : footer,
                   .options = {},
                   .commands = {}};
  for (const CLI::Option* option : command.get_options()) {
    const bool hidden = option->get_group().empty();
    if (!hidden) tree.options.push_back(describe(*option));
  }
  for (const CLI::App* below : command.get_subcommands([](const CLI::App*) { return true; })) {
    tree.commands.push_back(command_tree(*below, path + " " + below->get_name()));
  }
  return tree;
}

}  // namespace diminish
