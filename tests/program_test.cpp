#include <gmock/gmock.h>

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <thread>

#include "core/text.h"
#include "diminish/stage.h"
#include "masked_recording.h"
#include "paths.h"
#include "run_program.h"
#include "score/csv_table.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.insert(fs::relative(entry.path(), folder).string());
  }
  return names;
}

class ProgramTest : public ::testing::Test {
 protected:
  Program::Outcome run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"run", recording.folder(), "--out", recording.out()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Program::run(arguments);
  }
  fs::path out(const std::string& name) const { return fs::path(recording.out()) / name; }
  /// The recording without its RGB-D cameras.
  std::string lone(const std::string& from) const {
    const fs::path folder = recording.path("lone");
    fs::copy(from, folder, fs::copy_options::recursive);
    const std::string rig = read_text_file(folder / "rig.yaml", 1 << 20);
    recording.write("lone/rig.yaml", rig.substr(0, rig.find("rgbd:")) + "rgbd: []\n");
    return folder.string();
  }

  MaskedRecording recording;
};

TEST_F(ProgramTest, WritesWhatItPromises) {
  const auto outcome = run();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Reconstruction"));
  EXPECT_THAT(outcome.out, HasSubstr(recording.out()));
  std::set<std::string> expected = {"frames.csv", "summary.json", "result.mp4"};
  for (const char* folder : {"result", "mask", "reconstruction", "provenance"}) {
    for (const char* name : {"0", "1", "2"}) {
      expected.insert(std::string(folder) + "/" + name + ".png");
    }
  }
  EXPECT_EQ(files_in(recording.out()), expected);
  for (const char* name : {"0", "1", "2"}) {
    const std::string file = std::string(name) + ".png";
    const cv::Mat input = cv::imread(recording.path("color/" + file).string());
    const cv::Mat result = cv::imread(out("result/" + file).string());
    const cv::Mat mask = cv::imread(out("mask/" + file).string(), cv::IMREAD_GRAYSCALE);
    EXPECT_EQ(cv::norm(input, result, cv::NORM_INF, mask == 0), 0);
    EXPECT_GE(cv::countNonZero(mask), 80);
  }
  for (const CsvRow& row : load_csv(out("frames.csv"))) {
    EXPECT_NE(row.at("valid_pixels"), "0") << "the RGB-D camera sees behind the patch";
  }
}

TEST_F(ProgramTest, TheSameBytesWithOneAndTwoThreads) {
  ASSERT_EQ(run({"--threads", "1"}).exit_code, 0);
  const fs::path first = recording.path("first");
  fs::rename(recording.out(), first);
  ASSERT_EQ(run({"--threads", "2"}).exit_code, 0);
  for (const std::string& name : files_in(first)) {
    if (fs::path(name).extension() != ".png") continue;
    EXPECT_EQ(read_text_file(first / name, 1 << 20), read_text_file(out(name), 1 << 20)) << name;
  }
}

TEST_F(ProgramTest, PreviewsAreSideBySide) {
  ASSERT_EQ(run({"--preview"}).exit_code, 0);
  EXPECT_EQ(cv::imread(out("preview/1.png").string()).cols, 80);
  EXPECT_FALSE(fs::exists(out("result")));
}

// A broken RGB-D image costs the reconstruction, a broken colour image the frame; never the run.
TEST_F(ProgramTest, GoesOnWithoutImagesThatCannotBeUsed) {
  const fs::path depth = recording.path("rgbd0_depth/1.png");
  fs::resize_file(depth, fs::file_size(depth) / 2);
  fs::remove(recording.path("color/2.png"));
  const auto outcome = run();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_TRUE(fs::exists(out("result/0.png")));
  EXPECT_TRUE(fs::exists(out("result/1.png")));
  EXPECT_FALSE(fs::exists(out("result/2.png")));
  const auto rows = load_csv(out("frames.csv"));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].at("faults"), "");
  EXPECT_THAT(rows[1].at("faults"), HasSubstr("rgbd0_depth/1.png"));
  EXPECT_EQ(rows[1].at("valid_pixels"), "0");
  EXPECT_THAT(rows[2].at("faults"), HasSubstr("color/2.png"));
  EXPECT_EQ(rows[2].at("skipped"), "1");
}

TEST_F(ProgramTest, ReplacesResultsOnlyWhenForced) {
  ASSERT_EQ(run().exit_code, 0);
  const auto refused = run();
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("--force"));
  EXPECT_EQ(run({"--force"}).exit_code, 0);
}

TEST_F(ProgramTest, AnInterruptedRunLeavesWholeFiles) {
  const fs::path folder = recording.path("interrupted");
  Program program(
      {"run", testing::recordings_dir() + "/calendar", "--out", folder.string(), "--threads", "1"});
  for (int i = 0; i < 30000 && !fs::exists(folder / "result/000000.png"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill(program.process(), SIGINT);
  const auto outcome = program.wait();
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  const auto names = files_in(folder);
  for (const std::string& name : names) {
    EXPECT_NE(fs::path(name).filename().string().front(), '.') << name;
    if (fs::path(name).extension() != ".png") continue;
    EXPECT_FALSE(cv::imread((folder / name).string(), cv::IMREAD_UNCHANGED).empty()) << name;
  }
  const auto summary = nlohmann::json::parse(read_text_file(folder / "summary.json", 1 << 20));
  EXPECT_EQ(summary["complete"], false);
  const auto rows = load_csv(folder / "frames.csv");
  EXPECT_EQ(summary["frames"], rows.size());
  EXPECT_LT(rows.size(), 5U);
  EXPECT_EQ(names.count("result/000004.png"), 0U);
}

TEST_F(ProgramTest, ReportsOnOnePage) {
  fs::create_directories(recording.path("truth/background"));
  fs::create_directories(recording.path("truth/mask"));
  for (const char* name : {"0", "1", "2"}) {
    const std::string file = std::string(name) + ".png";
    fs::copy_file(recording.path("color/" + file), recording.path("truth/background/" + file));
    fs::copy_file(recording.path("masks/color/" + file), recording.path("truth/mask/" + file));
  }
  ASSERT_EQ(run().exit_code, 0);
  const auto outcome = Program::run({"report", recording.folder(), recording.out()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = read_text_file(out("report.html"), 1 << 24);
  // Three frames; input, result and truth.
  std::size_t pictures = 0;
  for (std::size_t at = page.find("data:image"); at != std::string::npos;
       at = page.find("data:image", at + 1)) {
    ++pictures;
  }
  EXPECT_EQ(pictures, 9U);
  EXPECT_THAT(page, ::testing::Not(HasSubstr("http"))) << "it must need nothing else";
  ASSERT_EQ(Program::run({"score", recording.folder(), recording.out()}).exit_code, 0);
  const auto score = nlohmann::json::parse(read_text_file(out("score.json"), 1 << 20));
  EXPECT_THAT(page, HasSubstr(fmt::format("PSNR {:.2f} dB",
                                          score["mean"]["inside"]["psnr_db"].get<double>())));
  EXPECT_THAT(page, HasSubstr("13256"));
  EXPECT_EQ(
      Program::run({"report", recording.folder(), recording.path("nowhere").string()}).exit_code,
      1);

  const auto complaint = [&] {
    const auto failed = Program::run({"report", recording.folder(), recording.out()});
    EXPECT_EQ(failed.exit_code, 1);
    return failed.err;
  };
  recording.write("out/frames.csv", "name,skipped,poses_ms\n0,0,1.5\n1,1,\n2,0,fast\n");
  EXPECT_THAT(complaint(), HasSubstr("frames.csv: row 3: poses_ms: expected a number, got 'fast'"));
  recording.write("out/summary.json", R"({"options": {"mask_margin_px": 0}})");
  EXPECT_THAT(complaint(),
              HasSubstr("summary.json: expected the summary that `diminish run` writes"));
}

TEST_F(ProgramTest, ScansAPlaceAndShowsItLater) {
  const std::string calendar = testing::recordings_dir() + "/calendar";
  const std::string room = recording.path("room").string();
  const auto scanned = Program::run({"scan", calendar, "--out", room});
  ASSERT_EQ(scanned.exit_code, 0) << scanned.err;
  EXPECT_THAT(scanned.out, HasSubstr(" keyframes of "));

  // A scan is a recording.
  ASSERT_EQ(Program::run({"run", room, "--out", recording.path("itself").string()}).exit_code, 0);

  const std::string without_rgbd = lone(calendar);
  const auto refused =
      Program::run({"run", without_rgbd, "--out", recording.out(), "--memory", "off"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("memory: expected 'on', and a background"));
  EXPECT_FALSE(fs::exists(recording.out()));
  const auto outcome =
      Program::run({"run", without_rgbd, "--background", room, "--out", recording.out()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("truly seen 0.0 %, remembered "));
  const auto summary = nlohmann::json::parse(read_text_file(out("summary.json"), 1 << 20));
  EXPECT_EQ(summary["options"]["memory"], "on");
  EXPECT_GT(summary["pixels"]["background"], 1000);
  EXPECT_EQ(summary["pixels"]["background"], summary["pixels"]["remembered"]);
}

TEST_F(ProgramTest, ScansWithLiveCameras) {
  const std::string calendar = testing::recordings_dir() + "/calendar";
  const std::string camera = "recording:" + calendar;
  const std::string room = recording.path("room").string();
  const auto scan = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"scan", calendar, "--out", room});
    return Program::run(arguments);
  };
  EXPECT_THAT(scan({"--record", room}).err, HasSubstr("--record: expected live cameras"));
  EXPECT_THAT(scan({"--rgbd", camera}).err, HasSubstr("--color: expected a camera"));
  // Slowly, and again and again: a busy machine leaves images out.
  const std::string slow = camera + "?loop&rate=.3";
  const auto scanned = scan({"--color", slow, "--rgbd", slow, "--seconds", "2.5"});
  ASSERT_EQ(scanned.exit_code, 0) << scanned.err;
  EXPECT_FALSE(fs::exists(room + ".recording"));
  const auto outcome =
      Program::run({"run", lone(calendar), "--background", room, "--out", recording.out()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(read_text_file(out("summary.json"), 1 << 20));
  EXPECT_GT(summary["pixels"]["background"], 1000);
}

TEST_F(ProgramTest, SaysWhatIsWrongWithABackground) {
  const std::string calendar = testing::recordings_dir() + "/calendar";
  const auto no_scan = run({"--background", calendar});
  EXPECT_EQ(no_scan.exit_code, 1);
  EXPECT_THAT(no_scan.err, HasSubstr("calendar/rig.yaml: rgbd: expected a scan"));
  const auto off = run({"--background", calendar, "--memory", "off"});
  EXPECT_EQ(off.exit_code, 2);
  EXPECT_THAT(off.err, HasSubstr("needs --memory on"));
  // Fixed poses: whose world would that be?
  const auto fixed = Program::run({"scan", recording.folder(), "--out", recording.out()});
  EXPECT_EQ(fixed.exit_code, 1);
  EXPECT_THAT(fixed.err, HasSubstr("rig.yaml:8: pose.source: expected marker or file"));
}

TEST_F(ProgramTest, ComparesTwoRunsOnOnePage) {
  fs::create_directories(recording.path("truth/background"));
  fs::create_directories(recording.path("truth/mask"));
  for (const char* name : {"0", "1", "2"}) {
    const std::string file = std::string(name) + ".png";
    fs::copy_file(recording.path("color/" + file), recording.path("truth/background/" + file));
    fs::copy_file(recording.path("masks/color/" + file), recording.path("truth/mask/" + file));
  }
  ASSERT_EQ(run().exit_code, 0);
  const std::string other = recording.path("other").string();
  ASSERT_EQ(
      Program::run({"run", recording.folder(), "--out", other, "--inpaint", "none"}).exit_code, 0);
  const auto compare = [&](const std::string& second, const std::string& page) {
    return Program::run({"compare", recording.out(), second, "--against", recording.folder(),
                         "--out", page, "--frames", "2"});
  };
  const std::string file = recording.path("page.html").string();
  const auto outcome = compare(other, file);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = read_text_file(file, 1 << 24);
  // Of each frame both runs, the truth, the input, and three differences.
  std::size_t pictures = 0;
  for (std::size_t at = page.find("data:image"); at != std::string::npos;
       at = page.find("data:image", at + 1)) {
    ++pictures;
  }
  EXPECT_EQ(pictures, 14U);
  EXPECT_THAT(page, ::testing::Not(HasSubstr("http")));
  EXPECT_THAT(page, HasSubstr("<tr><td>inpaint<td>&quot;structure&quot;<td>&quot;none&quot;"));
  const auto psnr_of = [&](const std::string& folder) {
    EXPECT_EQ(Program::run({"score", recording.folder(), folder}).exit_code, 0);
    const auto score = nlohmann::json::parse(read_text_file(folder + "/score.json", 1 << 20));
    return score["mean"]["inside"]["psnr_db"].get<double>();
  };
  const double first = psnr_of(recording.out());
  const double second = psnr_of(other);
  EXPECT_THAT(page, HasSubstr(fmt::format("PSNR inside, dB<td>{:.3f}<td>{:.3f}<td>{:+.3f}", first,
                                          second, second - first)));

  const auto failed = compare(recording.path("nowhere").string(), file);
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.err, HasSubstr("nowhere"));
}

TEST_F(ProgramTest, ExplainsItself) {
  const auto help = Program::run({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command : {"run", "scan", "score", "report", "compare", "train-color"}) {
    EXPECT_THAT(help.out, HasSubstr(command));
  }
  const auto run_help = Program::run({"run", "--help"});
  EXPECT_EQ(run_help.exit_code, 0);
  for (const char* text : {"--out", "--color-correct", "poisson", "--discontinuity-threshold-m"}) {
    EXPECT_THAT(run_help.out, HasSubstr(text));
  }
  EXPECT_THAT(Program::run({"--version"}).out, HasSubstr(DIMINISH_VERSION));
  EXPECT_EQ(Program::run({}).exit_code, 2);
  EXPECT_EQ(Program::run({"run", "--nonsense"}).exit_code, 2);
}

TEST_F(ProgramTest, BenchMeasuresEveryStage) {
  const fs::path file = recording.path("bench.json");
  const auto outcome = Program::run({"bench", recording.folder(), "--seconds", "0.01", "--threads",
                                     "2", "--json", file.string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Colour correction"));
  EXPECT_THAT(outcome.out, HasSubstr("13256"));
  const auto json = nlohmann::json::parse(read_text_file(file, 1 << 20));
  EXPECT_EQ(json.at("frames"), 3);
  EXPECT_EQ(json.at("threads"), 2);
  const auto& latency = json.at("latency_ms");
  EXPECT_GT(latency.at("min"), 0);
  for (const auto& [lower, upper] : {std::pair("min", "p50"), std::pair("p50", "p95"),
                                     std::pair("p95", "p99"), std::pair("p99", "max")}) {
    EXPECT_LE(latency.at(lower).get<double>(), latency.at(upper).get<double>()) << lower;
  }
  const auto average = [&](const std::string& stage) {
    return json.at("stages").at(stage).at("avg").get<double>();
  };
  for (const std::string stage : stage_names) EXPECT_GT(average(stage), 0) << stage;
  double one_after_the_other = 0;
  for (const std::string stage :
       {"poses", "objects", "compositing", "colors", "inpainting", "finish"}) {
    one_after_the_other += average(stage);
  }
  EXPECT_LE(one_after_the_other, latency.at("avg").get<double>());
  EXPECT_NEAR(average("paper_poses"), average("poses") + average("objects"), 1e-6);
  EXPECT_NEAR(average("paper_compositing"), average("compositing") + average("finish"), 1e-6);
  EXPECT_GT(json.at("span_ms"), 0);
  EXPECT_LE(json.at("span_ms"), json.at("work_ms"));
  EXPECT_GT(json.at("parallel_regions"), 0);
  EXPECT_GE(json.at("tasks"), 2 * json.at("parallel_regions").get<int>());
  double chain_ms = 0;
  for (const auto& [stage, ms] : json.at("span_by_stage_ms").items()) chain_ms += ms.get<double>();
  EXPECT_NEAR(chain_ms, json.at("span_ms").get<double>(), 0.5 * json.at("span_ms").get<double>());
  EXPECT_GT(json.at("throughput_fps"), 0);
  EXPECT_GT(json.at("peak_memory_bytes"), 1000000);
}

/// Events of a Chrome trace: each "complete" event of a thread lies within another or beside it.
TEST_F(ProgramTest, BenchWritesATrace) {
  const fs::path file = recording.path("trace.json");
  const auto outcome =
      Program::run({"bench", recording.folder(), "--seconds", "0.01", "--trace", file.string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(read_text_file(file, 1 << 24));
  struct Event {
    double begin_us, end_us;
  };
  std::map<int, std::vector<Event>> by_thread;
  std::map<std::string, int> count;
  int parts = 0;
  for (const auto& event : json.at("traceEvents")) {
    EXPECT_EQ(event.at("ph"), "X");
    EXPECT_EQ(event.at("pid"), 1);
    const double begin_us = event.at("ts");
    const double duration_us = event.at("dur");
    EXPECT_GE(begin_us, 0);
    EXPECT_GE(duration_us, 0);
    by_thread[event.at("tid").get<int>()].push_back({begin_us, begin_us + duration_us});
    const bool is_part = event.contains("args");
    if (is_part) {
      EXPECT_GE(event.at("args").at("part"), 0);
      ++parts;
    } else {
      ++count[event.at("name").get<std::string>()];
    }
  }
  EXPECT_EQ(count["frame"], 3);
  for (const std::string stage : stage_names) EXPECT_GE(count[stage], 3) << stage;
  EXPECT_GT(parts, 0);
  constexpr double rounding_us = 0.01;
  for (const auto& [thread, events] : by_thread) {
    std::vector<double> ends_us;  // of those that the event lies in
    for (const Event& event : events) {
      while (!ends_us.empty() && ends_us.back() <= event.begin_us + rounding_us) ends_us.pop_back();
      const double around_us = ends_us.empty() ? event.end_us : ends_us.back();
      EXPECT_LE(event.end_us, around_us + rounding_us);
      ends_us.push_back(event.end_us);
    }
  }
}

TEST_F(ProgramTest, BenchSaysWhatIsWrong) {
  const auto missing = Program::run({"bench", "/nowhere"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, HasSubstr("/nowhere"));
  EXPECT_EQ(Program::run({"bench", recording.folder(), "--frames", "0"}).exit_code, 2);
  const auto unwritable = Program::run(
      {"bench", recording.folder(), "--seconds", "0", "--json", "/nowhere/figures.json"});
  EXPECT_EQ(unwritable.exit_code, 1);
  EXPECT_THAT(unwritable.err, HasSubstr("/nowhere/figures.json"));
}

}  // namespace
}  // namespace diminish
