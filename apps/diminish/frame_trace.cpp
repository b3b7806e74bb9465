#include "frame_trace.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/tracing.h"
#include "sink/distribution.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

constexpr std::size_t most_traced = 20;

}  // namespace

Pipeline warm_pipeline(const Recording& input, const std::vector<FrameSet>& frames,
                       const Options& options, DiminishedFrame& result) {
  Pipeline pipeline(input.rig, input.scene, options);
  pipeline.want_reconstruction(false);
  for (const FrameSet& frame : frames) pipeline.process(frame, result);
  return pipeline;
}

WorkAndSpan measure_work_and_span(const Recording& input, const std::vector<FrameSet>& frames,
                                  const Options& options) {
  constexpr std::size_t fewest_frames = 20;
  std::vector<tracing::Cost> costs;
  oneapi::tbb::task_arena(1).execute([&] {
    DiminishedFrame result;
    Pipeline pipeline = warm_pipeline(input, frames, options, result);
    for (std::size_t i = 0; i < std::max(frames.size(), fewest_frames); ++i) {
      tracing::start(tracing::thread_now_ns);
      const tracing::Measurement measurement;
      pipeline.process(frames[i % frames.size()], result);
      costs.push_back(measurement.cost());
      tracing::stop();
    }
  });
  const auto median = [&](const auto& figure) {
    std::vector<double> values;
    values.reserve(costs.size());
    for (const tracing::Cost& cost : costs) values.push_back(static_cast<double>(figure(cost)));
    return distribution_of(std::move(values)).p50;
  };
  constexpr double ns_per_ms = 1e6;
  using tracing::Cost;
  WorkAndSpan median_cost{median([](const Cost& cost) { return cost.work_ns; }) / ns_per_ms,
                          median([](const Cost& cost) { return cost.span_ns; }) / ns_per_ms,
                          static_cast<int>(median([](const Cost& cost) { return cost.regions; })),
                          static_cast<int>(median([](const Cost& cost) { return cost.tasks; })),
                          {}};
  for (const char* const name : stage_names) {
    const double ns = median([&](const Cost& cost) {
      // Each file may have the name's text in a place of its own.
      const auto link =
          std::find_if(cost.chain.begin(), cost.chain.end(),
                       [&](const Cost::Link& each) { return std::string_view(each.name) == name; });
      return link == cost.chain.end() ? 0 : link->ns;
    });
    if (ns > 0) median_cost.chain_ms.emplace_back(name, ns / ns_per_ms);
  }
  return median_cost;
}

void write_trace(const Recording& input, const std::vector<FrameSet>& frames,
                 const Options& options, const std::filesystem::path& file) {
  DiminishedFrame result;
  Pipeline pipeline = warm_pipeline(input, frames, options, result);
  tracing::start();
  for (std::size_t i = 0; i < std::min(frames.size(), most_traced); ++i) {
    const tracing::Scope scope("frame");
    pipeline.process(frames[i], result);
  }
  const std::vector<tracing::Span> spans = tracing::stop();
  nlohmann::ordered_json events = nlohmann::ordered_json::array();
  for (const tracing::Span& span : spans) {
    const auto us = [&](std::int64_t ns) {
      return static_cast<double>(ns - spans.front().begin_ns) / 1e3;
    };
    nlohmann::ordered_json event = {{"name", span.name},
                                    {"ph", "X"},
                                    {"pid", 1},
                                    {"tid", span.thread},
                                    {"ts", us(span.begin_ns)},
                                    {"dur", us(span.end_ns) - us(span.begin_ns)}};
    if (span.part >= 0) event["args"] = {{"part", span.part}};
    events.push_back(std::move(event));
  }
  write_file(file, nlohmann::ordered_json{{"traceEvents", std::move(events)}}.dump() + "\n");
}

}  // namespace diminish
