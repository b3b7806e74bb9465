#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "beside_peer.h"
#include "core/robust.h"
#include "diminish/error.h"
#include "first_frame.h"

namespace diminish {
namespace {

/// Draws a bundled recording's first frame with the compute rasteriser, the paper's geometry shader
/// and the CPU, in turn. The benchmark's time is the first one's; the others' are counters, also
/// divided by the first one's. The label names the driver.
void draw(benchmark::State& state, const char* name, bool whole_view) {
  const testing::FirstFrame first(name);
  const Rect region = whole_view ? first.whole_view() : first.result.reconstruction.region;
  std::vector<std::unique_ptr<Reconstructor>> variants;
  try {
    for (const char* variant : {"gl", "gl_geometry", "cpu"}) {
      variants.push_back(Registry<Reconstructor>::get(variant)(first.rig()));
    }
  } catch (const Error& error) {
    state.SkipWithError(error.what());
    return;
  }
  Reconstruction reconstruction;
  const auto milliseconds_of = [&](Reconstructor& reconstructor) {
    return milliseconds([&] { first.reconstruct(reconstructor, region, reconstruction); });
  };
  for (const auto& variant : variants)
    milliseconds_of(*variant);  // lets memory grow to its final size
  std::vector<double> times[3];
  std::vector<double> gpu_ms;
  for (auto _ : state) {
    for (std::size_t i = 0; i < variants.size(); ++i) {
      times[i].push_back(milliseconds_of(*variants[i]));
    }
    state.SetIterationTime(times[0].back() / 1000);
    double sum_ms = 0;
    for (const GpuPass& pass : variants[0]->gpu_passes()) sum_ms += pass.milliseconds;
    gpu_ms.push_back(sum_ms);
  }
  const double ours = median(times[0]);
  state.SetLabel(variants[0]->device());
  state.counters["p50_ms"] = ours;
  state.counters["gpu_ms"] = median(gpu_ms);
  state.counters["geometry_ms"] = median(times[1]);
  state.counters["cpu_ms"] = median(times[2]);
  state.counters["to_geometry"] = median(times[1]) / ours;
  state.counters["to_cpu"] = median(times[2]) / ours;
}
BENCHMARK_CAPTURE(draw, calendar_mask, "calendar", false)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw, calendar_whole_view, "calendar", true)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw, ball_mask, "ball", false)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw, workbench_two_cameras_mask, "workbench", false)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw, workbench_two_cameras_whole_view, "workbench", true)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
