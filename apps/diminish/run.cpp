#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "background.h"
#include "commands.h"
#include "diminish/diminish.h"
#include "option_flags.h"
#include "progress.h"
#include "set_up_flags.h"

namespace diminish {
namespace {

constexpr int some_frames_faulty = 3;
constexpr int interrupted = 130;

std::atomic<bool> stop_run = false;

struct RunCommand {
  std::filesystem::path recording;
  std::filesystem::path out;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool force = false;
  bool preview = false;
  Options options;
  Background background;
  SetUpFlags flags;

  int execute() const;
};

int RunCommand::execute() const {
  Recording input = load_recording(recording);
  flags.apply(input.rig, input.scene);
  check(options, input.rig, input.scene);
  const auto source = open_recording(input, options);
  RunnerOptions runner;
  runner.background = background.load();
  std::error_code ignored;
  if (std::filesystem::equivalent(recording, out, ignored)) {
    throw Error(out.string() + ": --out is the recording itself, expected another folder");
  }
  ResultWriter writer(out, input.rig, options, source->frames_per_second(),
                      {.preview_only = preview, .force = force});

  std::signal(SIGINT, [](int) { stop_run = true; });
  std::signal(SIGTERM, [](int) { stop_run = true; });
  runner.threads = threads;
  runner.reconstructions = !preview;
  runner.stop = &stop_run;
  runner.progress = [total = source->frame_count()](std::size_t done) {
    show_progress(done, total);
  };
  run(*source, input.rig, input.scene, options, writer, runner);
  const std::string video_problem = writer.finish(stop_run);
  if (!video_problem.empty()) fmt::print(stderr, "diminish: {}\n", video_problem);

  fmt::print("{}\n", writer.table());
  fmt::print("Written to {}\n", out.string());
  if (stop_run) return interrupted;
  return writer.faulty_frames() > 0 ? some_frames_faulty : 0;
}

}  // namespace

void add_run(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<RunCommand>();
  CLI::App* sub = program.add_subcommand(
      "run", "Removes the objects of a recording and writes what the colour camera would see");
  sub->add_option("recording", command->recording, "The recording's folder (rig.yaml, scene.yaml)")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("--out", command->out, "Folder for the results; created if missing")
      ->type_name("FOLDER")
      ->required();
  sub->add_flag("--force", command->force, "Replace existing results in --out");
  sub->add_flag("--preview", command->preview,
                "Write only pictures that show input and result side by side");
  sub->add_option("--threads", command->threads,
                  "Frames to process at a time; does not change the results")
      ->default_str("the CPU's")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  add_option_flags(*sub, command->options);
  command->background.add_flag(*sub, command->options);
  command->flags.add_to(*sub);
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
