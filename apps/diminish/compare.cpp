#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "diminish/report.h"
#include "heap.h"

namespace diminish {

void add_compare(CLI::App& program, int& exit_code) {
  struct Command {
    std::filesystem::path first, second, recording, file;
    int frames = 8;
  };
  auto command = std::make_shared<Command>();
  CLI::App* sub = program.add_subcommand(
      "compare", "Makes one HTML page that shows two runs side by side, against the truth");
  sub->add_option("first", command->first, "A folder that `diminish run --out` wrote")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("second", command->second, "Another, of the same recording")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("--against", command->recording, "The recording's folder (with truth/)")
      ->required()
      ->type_name("FOLDER");
  sub->add_option("--out", command->file, "Where to write the page; default: SECOND/compare.html")
      ->type_name("FILE");
  sub->add_option("--frames", command->frames, "How many of the frames that differ most are shown")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000))
      ->type_name("N");
  sub->callback([command, &exit_code] {
    heap_for_scoring();
    const std::filesystem::path file =
        command->file.empty() ? command->second / "compare.html" : command->file;
    write_comparison(command->recording, command->first, command->second, file, command->frames);
    fmt::print("Written to {}\n", file.string());
    exit_code = 0;
  });
}

}  // namespace diminish
