#include "diminish/score.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "heap.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

struct ScoreCommand {
  std::filesystem::path recording;
  std::filesystem::path run;
  std::filesystem::path json;
  bool pictures = false;

  void execute() const {
    heap_for_scoring();
    const Score score =
        pictures ? score_run_with_pictures(recording, run) : score_run(recording, run);
    fmt::print("{}", score_table(score));
    write_file(json.empty() ? run / "score.json" : json, score_json(score));
  }
};

}  // namespace

void add_score(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<ScoreCommand>();
  CLI::App* sub =
      program.add_subcommand("score", "Compares a run's results with the recording's truth");
  sub->add_option("recording", command->recording, "The recording's folder (with truth/)")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("run", command->run, "The folder that `diminish run --out` wrote")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("--json", command->json, "Where to write the figures; default: RUN/score.json")
      ->type_name("FILE");
  sub->add_flag("--pictures", command->pictures,
                "Write RUN/score/NAME.png: input, result, truth and error side by side");
  sub->callback([command, &exit_code] {
    command->execute();
    exit_code = 0;
  });
}

}  // namespace diminish
