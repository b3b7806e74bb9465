#include "diminish/report.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "heap.h"

namespace diminish {

void add_report(CLI::App& program, int& exit_code) {
  struct Command {
    std::filesystem::path recording, run, file;
  };
  auto command = std::make_shared<Command>();
  CLI::App* sub = program.add_subcommand(
      "report", "Makes one HTML page about a run: pictures, plots, times, figures");
  sub->add_option("recording", command->recording, "The recording's folder (with truth/)")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("run", command->run, "The folder that `diminish run --out` wrote")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("--out", command->file, "Where to write the page; default: RUN/report.html")
      ->type_name("FILE");
  sub->callback([command, &exit_code] {
    heap_for_scoring();
    const std::filesystem::path file =
        command->file.empty() ? command->run / "report.html" : command->file;
    write_report(command->recording, command->run, file);
    fmt::print("Written to {}\n", file.string());
    exit_code = 0;
  });
}

}  // namespace diminish
