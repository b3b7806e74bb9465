#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "command_tree.h"
#include "commands.h"
#include "completion.h"
#include "diminish/error.h"
#include "man_page.h"

namespace diminish {
namespace {

struct HelpCommand {
  std::vector<std::string> command;
  bool man = false;
  std::string completion;
  std::filesystem::path write_to;

  void execute(const CLI::App& program) const;
};

void write(const std::filesystem::path& file, const std::string& text) {
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw Error(file.string() + ": cannot be written");
}

/// man/ has a page for each command; completion/ has the three scripts, each by the name that its
/// shell looks for.
void write_all(const CommandTree& program, const std::filesystem::path& folder) {
  for_each_command(program, [&](const CommandTree& command) {
    write(folder / "man" / man_page_name(command), man_page(command));
  });
  write(folder / "completion" / "diminish", bash_completion(program));
  write(folder / "completion" / "_diminish", zsh_completion(program));
  write(folder / "completion" / "diminish.fish", fish_completion(program));
}

std::string completion_for(const std::string& shell, const CommandTree& program) {
  if (shell == "bash") return bash_completion(program);
  return shell == "zsh" ? zsh_completion(program) : fish_completion(program);
}

void HelpCommand::execute(const CLI::App& program) const {
  const CLI::App* chosen = &program;
  std::string path = program.get_name();
  for (const std::string& word : command) {
    const auto named = chosen->get_subcommands(
        [&word](const CLI::App* below) { return below->get_name() == word; });
    if (named.empty()) {
      throw Error(fmt::format("help: expected a command of {}, got '{}'", path, word));
    }
    chosen = named.front();
    path += ' ';
    path += word;
  }
  if (!write_to.empty()) {
    write_all(command_tree(program, program.get_name()), write_to);
  } else if (!completion.empty()) {
    fmt::print("{}", completion_for(completion, command_tree(program, program.get_name())));
  } else if (man) {
    fmt::print("{}", man_page(command_tree(*chosen, path)));
  } else {
    fmt::print("{}", chosen->get_formatter()->make_help(chosen, path, CLI::AppFormatMode::Normal));
  }
}

}  // namespace

void add_help(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<HelpCommand>();
  CLI::App* sub =
      program.add_subcommand("help", "Explains a command; makes man pages and shell completion");
  sub->add_option("command", command->command, "The command, such as run or calibrate rig");
  sub->add_flag("--man", command->man, "Print a page for man instead");
  sub->add_option("--completion", command->completion, "Print what makes this shell complete words")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  sub->add_option("--write-to", command->write_to,
                  "Write all man pages and completion scripts to this folder")
      ->type_name("FOLDER");
  sub->callback([command, &program, &exit_code] {
    command->execute(program);
    exit_code = 0;
  });
}

}  // namespace diminish
