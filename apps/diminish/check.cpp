#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "diminish/frame_source.h"
#include "diminish/setup_check.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

constexpr int something_is_wrong = 3;

struct CheckCommand {
  std::filesystem::path recording;
  std::filesystem::path json;
  std::size_t frames = 300;

  int execute() const {
    const Recording input = load_recording(recording);
    const auto source = open_recording(input, Options{});
    const SetupReport report = check_setup(input.rig, input.scene, *source, frames);
    fmt::print("{}", setup_report_text(report));
    if (!json.empty()) write_file(json, setup_report_json(report));
    return report.fine() ? 0 : something_is_wrong;
  }
};

}  // namespace

void add_check(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<CheckCommand>();
  CLI::App* sub =
      program.add_subcommand("check", "Looks at a set-up and says in plain words what is wrong");
  sub->add_option("recording", command->recording, "The recording's folder")->required();
  sub->add_option("--frames", command->frames, "At most so many frames, from the first on")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  sub->add_option("--json", command->json, "Write findings and figures to this file, too")
      ->type_name("FILE");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
