#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <thread>

#include "allocations.h"
#include "bench_figures.h"
#include "commands.h"
#include "diminish/diminish.h"
#include "diminish/runner.h"
#include "frame_trace.h"
#include "looped_recording.h"
#include "option_flags.h"
#include "preloaded_source.h"
#include "set_up_flags.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

using Clock = std::chrono::steady_clock;

/// Of any measurement, however short.
constexpr std::size_t fewest_frames = 20;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Of all threads together, since the process began.
double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Counts frames from the end of a warm-up on, until there are enough of them and enough time has
/// passed.
class RateMeter {
 public:
  RateMeter(std::size_t warm_up, double seconds) : warm_up_(warm_up), seconds_(seconds) {}

  /// True from the last frame on.
  bool count() {
    if (++frames_ == warm_up_) {
      start_ = Clock::now();
      cpu_s_ = cpu_s();
    }
    return frames_ >= warm_up_ + fewest_frames && seconds_since(start_) >= seconds_;
  }
  Rate rate() const {
    const auto timed = static_cast<double>(frames_ - warm_up_);
    return {timed / seconds_since(start_), 1000 * (cpu_s() - cpu_s_) / timed};
  }

 private:
  std::size_t warm_up_;
  double seconds_;
  std::size_t frames_ = 0;
  Clock::time_point start_;
  double cpu_s_ = 0;
};

struct BenchCommand {
  std::filesystem::path recording;
  std::filesystem::path json;
  std::filesystem::path trace;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  int busy = 0;  ///< threads that compute something else
  std::size_t frames = 0;
  double seconds = 3;
  Options options;
  SetUpFlags flags;

  int execute() const;

 private:
  /// Frames that let each thread's memory grow to its size.
  std::size_t warm_up() const { return 2 * static_cast<std::size_t>(threads); }

  std::vector<FrameSet> load(const Recording& input, BenchFigures& figures) const;
  void measure_latency(const Recording& input, const std::vector<FrameSet>& frames,
                       BenchFigures& figures) const;
  void measure_backend(const Recording& input, const std::vector<FrameSet>& frames,
                       BenchFigures& figures) const;
  void measure_memory(const Recording& input, const std::vector<FrameSet>& frames,
                      BenchFigures& figures) const;
  void measure_throughput(const Recording& input, std::vector<FrameSet> frames,
                          BenchFigures& figures) const;
  Rate run_rate(const Recording& input, FrameSource& source) const;
  Rate reading_rate(FrameSource& source) const;
};

Allocations allocations_until_now() {
  return count_allocations ? count_allocations() : Allocations{};
}

/// Threads that keep a core busy each, as other programs do.
class BusyThreads {
 public:
  explicit BusyThreads(int count) {
    for (int i = 0; i < count; ++i) {
      threads_.emplace_back([](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
        }
      });
    }
  }

 private:
  std::vector<std::jthread> threads_;
};

class NoSink : public FrameSink {
 public:
  void write_images(const FrameSet&, const DiminishedFrame&) override {}
  void append(const FrameSet&, const DiminishedFrame&) override {}
};

std::vector<FrameSet> BenchCommand::load(const Recording& input, BenchFigures& figures) const {
  const auto source = open_recording(input, options);
  std::vector<FrameSet> loaded;
  FrameSet frame;
  while ((frames == 0 || loaded.size() < frames) && source->next(frame)) {
    if (frame.color.empty()) {
      ++figures.left_out;
    } else {
      loaded.push_back(frame);
    }
  }
  if (loaded.empty()) {
    throw Error(recording.string() + ": expected at least one frame with a colour image");
  }
  figures.frames = loaded.size();
  return loaded;
}

void BenchCommand::measure_latency(const Recording& input, const std::vector<FrameSet>& loaded,
                                   BenchFigures& figures) const {
  DiminishedFrame result;
  Pipeline pipeline = warm_pipeline(input, loaded, options, result);
  std::array<std::vector<double>, time_row_count> times;
  std::vector<double> bytes;
  std::vector<double> counts;
  const Clock::time_point start = Clock::now();
  for (std::size_t i = 0; i < fewest_frames || seconds_since(start) < seconds; ++i) {
    const Allocations before = allocations_until_now();
    pipeline.process(loaded[i % loaded.size()], result);
    const Allocations after = allocations_until_now();
    bytes.push_back(static_cast<double>(after.bytes - before.bytes));
    counts.push_back(static_cast<double>(after.count - before.count));
    const auto ms = times_of(result.report);
    for (std::size_t row = 0; row < time_row_count; ++row) times[row].push_back(ms[row]);
  }
  figures.measured = bytes.size();
  for (std::size_t i = 0; i < times.size(); ++i) {
    figures.times_ms[i] = distribution_of(std::move(times[i]));
  }
  figures.allocated_bytes = distribution_of(std::move(bytes));
  figures.allocations = distribution_of(std::move(counts));
}

/// Two pipelines, frame by frame in turn: a machine whose speed drifts slows both.
/// each(first_ms, second_ms, report): the second's report.
template <class Each>
void process_in_turn(Pipeline& first, Pipeline& second, const std::vector<FrameSet>& loaded,
                     double seconds, const Each& each) {
  constexpr std::size_t warm_up = fewest_frames / 2;  // lets memory grow to its size
  DiminishedFrame result;
  const auto ms_of = [&](Pipeline& pipeline, const FrameSet& frame) {
    const Clock::time_point begun = Clock::now();
    pipeline.process(frame, result);
    return 1000 * seconds_since(begun);
  };
  const Clock::time_point start = Clock::now();
  for (std::size_t i = 0; i < warm_up + fewest_frames || seconds_since(start) < seconds; ++i) {
    const FrameSet& frame = loaded[i % loaded.size()];
    const double first_ms = ms_of(first, frame);
    const double second_ms = ms_of(second, frame);
    if (i >= warm_up) each(first_ms, second_ms, result.report);
  }
}

/// The chosen backend beside the CPU's.
void BenchCommand::measure_backend(const Recording& input, const std::vector<FrameSet>& loaded,
                                   BenchFigures& figures) const {
  Options by_cpu = options;
  by_cpu.backend = "cpu";
  Pipeline chosen(input.rig, input.scene, options);
  Pipeline cpu(input.rig, input.scene, by_cpu);
  chosen.want_reconstruction(false);
  std::vector<double> chosen_ms;
  std::vector<double> cpu_ms;
  std::vector<std::pair<std::string, std::vector<double>>> passes;
  process_in_turn(cpu, chosen, loaded, seconds,
                  [&](double of_cpu_ms, double of_chosen_ms, const FrameReport& report) {
                    cpu_ms.push_back(of_cpu_ms);
                    chosen_ms.push_back(of_chosen_ms);
                    const DrawingReport& drawing = report.drawing;
                    figures.device = drawing.device;
                    passes.resize(drawing.passes.size());
                    for (std::size_t k = 0; k < passes.size(); ++k) {
                      passes[k].first = drawing.passes[k].name;
                      passes[k].second.push_back(drawing.passes[k].milliseconds);
                    }
                  });
  figures.frame_ms = distribution_of(std::move(chosen_ms)).p50;
  figures.cpu_frame_ms = distribution_of(std::move(cpu_ms)).p50;
  for (auto& [name, times] : passes) {
    figures.gpu_passes_ms.emplace_back(name, distribution_of(std::move(times)).p50);
  }
}

/// Each frame with the memory beside the same without.
void BenchCommand::measure_memory(const Recording& input, const std::vector<FrameSet>& loaded,
                                  BenchFigures& figures) const {
  Options without = options;
  without.memory = "off";
  Pipeline remembering(input.rig, input.scene, options);
  Pipeline forgetful(input.rig, input.scene, without);
  for (Pipeline* pipeline : {&remembering, &forgetful}) pipeline->want_reconstruction(false);
  std::vector<double> remembering_ms;
  std::vector<double> forgetful_ms;
  std::vector<double> more_ms;
  process_in_turn(forgetful, remembering, loaded, seconds,
                  [&](double without_ms, double with_ms, const FrameReport&) {
                    forgetful_ms.push_back(without_ms);
                    remembering_ms.push_back(with_ms);
                    more_ms.push_back(with_ms - without_ms);
                  });
  figures.remembering_frame_ms = distribution_of(std::move(remembering_ms)).p50;
  figures.forgetful_frame_ms = distribution_of(std::move(forgetful_ms)).p50;
  figures.memory_ms = distribution_of(std::move(more_ms));
}

void BenchCommand::measure_throughput(const Recording& input, std::vector<FrameSet> loaded,
                                      BenchFigures& figures) const {
  PreloadedSource preloaded(std::move(loaded));
  figures.throughput_fps = run_rate(input, preloaded).fps;
  LoopedRecording to_read(input, options);
  figures.reading = reading_rate(to_read);
  LoopedRecording to_run(input, options);
  figures.run = run_rate(input, to_run);
}

/// Of a run that writes nothing.
Rate BenchCommand::run_rate(const Recording& input, FrameSource& source) const {
  NoSink sink;
  std::atomic<bool> enough = false;
  RunnerOptions runner;
  runner.threads = threads;
  runner.reconstructions = false;
  runner.stop = &enough;
  RateMeter meter(warm_up(), seconds);
  Rate rate;
  runner.progress = [&](std::size_t) {
    if (enough || !meter.count()) return;
    rate = meter.rate();
    enough = true;
  };
  run(source, input.rig, input.scene, options, sink, runner);
  return rate;
}

/// Of as many threads that read and decode.
Rate BenchCommand::reading_rate(FrameSource& source) const {
  std::mutex order;
  RateMeter meter(warm_up(), seconds);
  Rate rate;
  bool enough = false;
  {
    std::vector<std::jthread> readers;
    readers.reserve(static_cast<std::size_t>(threads));
    for (int i = 0; i < threads; ++i) {
      readers.emplace_back([&] {
        for (FrameSet frame;; source.read_images(frame)) {
          const std::lock_guard lock(order);
          if (enough || !source.begin(frame)) return;
          enough = meter.count();
          if (enough) rate = meter.rate();
        }
      });
    }
  }
  return rate;
}

int BenchCommand::execute() const {
  Recording input = load_recording(recording);
  flags.apply(input.rig, input.scene);
  check(options, input.rig, input.scene);
  BenchFigures figures;
  std::vector<FrameSet> loaded = load(input, figures);
  figures.start_up = measure_start_up(input, loaded, options);
  figures.cost = measure_work_and_span(input, loaded, options);
  const BusyThreads others(busy);
  measure_latency(input, loaded, figures);
  if (!trace.empty()) write_trace(input, loaded, options, trace);
  if (options.backend != "cpu") measure_backend(input, loaded, figures);
  if (options.memory != "off") measure_memory(input, loaded, figures);
  measure_throughput(input, std::move(loaded), figures);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  figures.peak_memory_bytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  print(figures, threads);
  if (!json.empty()) {
    write_file(json, to_json(figures, {recording, threads, busy}).dump(2) + "\n");
  }
  return 0;
}

}  // namespace

void add_bench(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<BenchCommand>();
  CLI::App* sub = program.add_subcommand(
      "bench", "Measures the pipeline's speed on a recording, with all frames decoded first");
  sub->add_option("recording", command->recording, "The recording's folder (rig.yaml, scene.yaml)")
      ->type_name("FOLDER")
      ->required();
  sub->add_option("--threads", command->threads,
                  "Frames to process at a time when measuring throughput")
      ->default_str("the CPU's")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  sub->add_option("--busy", command->busy, "Threads that keep a core busy each beside it")
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
  sub->add_option("--frames", command->frames, "Use only the first N frames; default: all")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  sub->add_option("--seconds", command->seconds, "Duration of each measurement")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 3600.0))
      ->type_name("S");
  sub->add_option("--json", command->json, "Also write the figures to this file")
      ->type_name("FILE");
  sub->add_option("--trace", command->trace,
                  "Also write who did what, when, to this file (a Chrome trace, for Perfetto)")
      ->type_name("FILE");
  add_option_flags(*sub, command->options);
  command->flags.add_to(*sub);
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
