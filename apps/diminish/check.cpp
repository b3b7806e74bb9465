#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "diminish/frame_source.h"
#include "diminish/setup_check.h"
#include "live/live_frame_source.h"
#include "live_setup.h"
#include "setup/check/host_traps.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

constexpr int something_is_wrong = 3;

struct CheckCommand {
  LiveSetup setup;
  std::filesystem::path json;
  std::size_t frames = 300;
  double seconds = 10;

  SetupReport look() const {
    const Recording input = load_recording(setup.folder);
    if (setup.has_live_cameras(input.rig)) {
      const LiveRun run = setup.start();
      LiveFrameSource source(*run.session, seconds);
      SetupReport report = check_setup(input.rig, input.scene, source, frames);
      for (Finding& trap : host_traps(input.rig, setup.cameras(input.rig))) {
        report.findings.push_back(std::move(trap));
      }
      return report;
    }
    const auto source = open_recording(input, Options{});
    return check_setup(input.rig, input.scene, *source, frames);
  }

  int execute() const {
    const SetupReport report = look();
    fmt::print("{}", setup_report_text(report));
    if (!json.empty()) write_file(json, setup_report_json(report));
    return report.fine() ? 0 : something_is_wrong;
  }
};

}  // namespace

void add_check(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<CheckCommand>();
  CLI::App* sub =
      program.add_subcommand("check", "Checks a set-up and says in plain words what is wrong");
  sub->add_option("recording", command->setup.folder,
                  "A recording; or, with live cameras, a folder with rig.yaml and scene.yaml")
      ->type_name("FOLDER")
      ->required();
  command->setup.add_camera_flags(*sub);
  sub->add_option("--seconds", command->seconds, "How long to watch live cameras")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 3600.0))
      ->type_name("S");
  sub->add_option("--frames", command->frames, "Use at most the first N frames")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  sub->add_option("--json", command->json, "Also write findings and figures to this file")
      ->type_name("FILE");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
