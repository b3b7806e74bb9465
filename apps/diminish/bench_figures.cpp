#include "bench_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "allocations.h"

namespace diminish {
namespace {

nlohmann::ordered_json to_json(const Distribution& d) {
  return {{"avg", d.average}, {"min", d.least}, {"max", d.most},
          {"p50", d.p50},     {"p95", d.p95},   {"p99", d.p99}};
}

std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  const std::string key = "model name";
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with(key) && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

void print(const BenchFigures& figures, int threads) {
  for (const TimeGroup& group : time_groups) {
    fmt::print("{:<20}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>16}\n", group.title, "avg", "min", "max",
               "p50", "p95", "p99", group.paper_title);
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const TimeRow& row = time_rows()[i];
      const Distribution& d = figures.times_ms[i];
      fmt::print("{:<20}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>16}\n", row.title,
                 d.average, d.least, d.most, d.p50, d.p95, d.p99, row.paper_ms);
    }
  }
  const Distribution& total = figures.times_ms[whole_frame_row];
  fmt::print("{} frames, measured {} times; {} skipped without a colour image\n", figures.frames,
             figures.measured, figures.left_out);
  fmt::print("One at a time: p50 {:.2f}, p95 {:.2f}, p99 {:.2f} ms; {:.1f} frames/s\n", total.p50,
             total.p95, total.p99, 1000 / total.average);
  fmt::print("Work {:.2f} ms, span {:.2f} ms: at best {:.1f} times as fast as on one core\n",
             figures.cost.work_ms, figures.cost.span_ms,
             figures.cost.work_ms / std::max(figures.cost.span_ms, 1e-6));
  fmt::print("Longest chain, ms:");
  for (const auto& [stage, ms] : figures.cost.chain_ms) fmt::print(" {} {:.2f}", stage, ms);
  fmt::print("\nParallel regions: {}, with {} tasks of {:.0f} us\n", figures.cost.regions,
             figures.cost.tasks, 1000 * figures.cost.work_ms / std::max(figures.cost.tasks, 1));
  fmt::print("Pipelined, {} threads: {:.1f} frames/s\n", threads, figures.throughput_fps);
  fmt::print("From files: {:.1f} frames/s; reading alone {:.1f} frames/s, ratio {:.2f}\n",
             figures.run.fps, figures.reading.fps, figures.run.fps / figures.reading.fps);
  fmt::print("  each core busy: {:.1f} ms a frame, {:.1f} of them for reading: a ratio of {:.2f}\n",
             figures.run.cpu_ms, figures.reading.cpu_ms,
             figures.reading.cpu_ms / figures.run.cpu_ms);
  if (figures.frame_ms > 0) {
    fmt::print("Frame on {}: p50 {:.2f} ms; with the CPU backend {:.2f} ms, ratio {:.2f}\n",
               figures.device.empty() ? "the CPU" : figures.device, figures.frame_ms,
               figures.cpu_frame_ms, figures.cpu_frame_ms / figures.frame_ms);
  }
  if (figures.remembering_frame_ms > 0) {
    fmt::print(
        "Frame with memory: p50 {:.2f} ms; without {:.2f} ms, ratio {:.2f}; "
        "longer by p50 {:.2f}, p95 {:.2f}, p99 {:.2f} ms\n",
        figures.remembering_frame_ms, figures.forgetful_frame_ms,
        figures.remembering_frame_ms / figures.forgetful_frame_ms, figures.memory_ms.p50,
        figures.memory_ms.p95, figures.memory_ms.p99);
  }
  double gpu_ms = 0;
  for (const auto& [name, ms] : figures.gpu_passes_ms) {
    fmt::print("  GPU time, {:<10}{:>9.3f} ms\n", name, ms);
    gpu_ms += ms;
  }
  if (gpu_ms > 0) fmt::print("  GPU time, {:<10}{:>9.3f} ms\n", "total", gpu_ms);
  fmt::print("Start-up: {:.0f} ms to the first frame; {:.0f} MB for each pipeline\n",
             figures.start_up.first_frame_ms,
             static_cast<double>(figures.start_up.pipeline_bytes) / 1e6);
  fmt::print("Peak memory: {:.0f} MB\n", static_cast<double>(figures.peak_memory_bytes) / 1e6);
  if (count_allocations) {
    fmt::print("Allocated per frame: {:.0f} bytes (at most {:.0f}) in {:.0f} allocations\n",
               figures.allocated_bytes.p50, figures.allocated_bytes.most, figures.allocations.p50);
  } else {
    fmt::print("Allocated per frame: not counted, except in builds with benchmarks\n");
  }
}

nlohmann::ordered_json to_json(const BenchFigures& figures, const BenchSetting& setting) {
  const Distribution& total = figures.times_ms[whole_frame_row];
  nlohmann::ordered_json json;
  json["recording"] = setting.recording.string();
  json["frames"] = figures.frames;
  json["threads"] = setting.threads;
  json["busy"] = setting.busy;
  json["machine"] = {{"cpu", cpu_name()}, {"cores", std::thread::hardware_concurrency()}};
  json["latency_ms"] = to_json(total);
  json["latency_fps"] = 1000 / total.average;
  json["throughput_fps"] = figures.throughput_fps;
  json["from_files_fps"] = figures.run.fps;
  json["reading_fps"] = figures.reading.fps;
  json["from_files_cpu_ms"] = figures.run.cpu_ms;
  json["reading_cpu_ms"] = figures.reading.cpu_ms;
  json["work_ms"] = figures.cost.work_ms;
  json["span_ms"] = figures.cost.span_ms;
  for (const auto& [stage, ms] : figures.cost.chain_ms) json["span_by_stage_ms"][stage] = ms;
  json["parallel_regions"] = figures.cost.regions;
  json["tasks"] = figures.cost.tasks;
  for (std::size_t row = 0; row < time_row_count; ++row) {
    json["stages"][time_rows()[row].key] = to_json(figures.times_ms[row]);
  }
  if (figures.frame_ms > 0) {
    json["backend"] = {{"device", figures.device},
                       {"frame_p50_ms", figures.frame_ms},
                       {"cpu_frame_p50_ms", figures.cpu_frame_ms}};
    for (const auto& [name, ms] : figures.gpu_passes_ms) json["backend"]["gpu_ms"][name] = ms;
  }
  if (figures.remembering_frame_ms > 0) {
    json["memory"] = {{"frame_p50_ms", figures.remembering_frame_ms},
                      {"off_frame_p50_ms", figures.forgetful_frame_ms},
                      {"longer_ms", to_json(figures.memory_ms)}};
  }
  json["first_frame_ms"] = figures.start_up.first_frame_ms;
  json["pipeline_bytes"] = figures.start_up.pipeline_bytes;
  json["peak_memory_bytes"] = figures.peak_memory_bytes;
  if (count_allocations) {
    json["allocated_bytes_per_frame"] = figures.allocated_bytes.p50;
  }
  return json;
}

}  // namespace diminish
