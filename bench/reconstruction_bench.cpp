#include <benchmark/benchmark.h>

#include "beside_peer.h"
#include "first_frame.h"

namespace diminish {
namespace {

/// A bundled recording's first frame, with the poses that the pipeline found in it.
void reconstruct(benchmark::State& state, const char* name, bool whole_view) {
  const testing::FirstFrame first(name);
  const Rect region = whole_view ? first.whole_view() : first.result.reconstruction.region;
  const auto fast = Registry<Reconstructor>::get("cpu")(first.rig());
  const auto plain = Registry<Reconstructor>::get("reference")(first.rig());
  Reconstruction reconstruction;
  run_beside_peer(
      state, [&] { first.reconstruct(*fast, region, reconstruction); },
      [&] { first.reconstruct(*plain, region, reconstruction); });
}
BENCHMARK_CAPTURE(reconstruct, calendar_mask, "calendar", false)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(reconstruct, calendar_whole_view, "calendar", true)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(reconstruct, workbench_two_cameras, "workbench", true)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
