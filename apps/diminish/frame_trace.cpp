#include "frame_trace.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <nlohmann/json.hpp>

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
  std::vector<double> work_ms;
  std::vector<double> span_ms;
  oneapi::tbb::task_arena(1).execute([&] {
    DiminishedFrame result;
    Pipeline pipeline = warm_pipeline(input, frames, options, result);
    for (std::size_t i = 0; i < std::max(frames.size(), most_traced); ++i) {
      tracing::start();
      const tracing::Measurement measurement;
      pipeline.process(frames[i % frames.size()], result);
      const tracing::Cost cost = measurement.cost();
      tracing::stop();
      work_ms.push_back(static_cast<double>(cost.work_ns) / 1e6);
      span_ms.push_back(static_cast<double>(cost.span_ns) / 1e6);
    }
  });
  return {distribution_of(std::move(work_ms)).p50, distribution_of(std::move(span_ms)).p50};
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
