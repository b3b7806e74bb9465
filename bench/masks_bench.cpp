#include <benchmark/benchmark.h>

#include "beside_peer.h"
#include "core/robust.h"
#include "detect/occlusion_masks.h"
#include "first_frame.h"

namespace diminish {
namespace {

/// Outlines and draws the objects of a bundled recording's first frame in all its images, on the
/// GPU and on the CPU, in turn. The benchmark's time is the GPU's; the CPU's is a counter, also
/// divided by the GPU's.
void masks(benchmark::State& state, const char* name) {
  const testing::FirstFrame first(name);
  OccluderStage stages[2] = {{first.rig(), first.recording.scene},
                             {first.rig(), first.recording.scene}};
  stages[0].draw_by("gl");
  const FrameReport& report = first.result.report;
  std::vector<OccluderReport> reports;
  const auto milliseconds_of = [&](OccluderStage& stage) {
    return milliseconds([&] {
      stage.detect({first.frame, report.markers, report.poses, first.options}, reports);
    });
  };
  std::vector<double> times[2];
  for (OccluderStage& stage : stages) milliseconds_of(stage);  // lets memory grow to its final size
  if (!stages[0].message().empty()) return state.SkipWithError(stages[0].message().c_str());
  for (auto _ : state) {
    for (int i = 0; i < 2; ++i) times[i].push_back(milliseconds_of(stages[i]));
    state.SetIterationTime(times[0].back() / 1000);
  }
  state.counters["p50_ms"] = median(times[0]);
  state.counters["cpu_ms"] = median(times[1]);
  state.counters["to_cpu"] = median(times[1]) / median(times[0]);
}
BENCHMARK_CAPTURE(masks, calendar_hull, "calendar")->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(masks, workbench_mesh, "workbench")
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
