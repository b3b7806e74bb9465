#include <benchmark/benchmark.h>

#include "analytic_scene.h"
#include "beside_peer.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "diminish/reconstructor.h"

namespace diminish {
namespace {

/// A bundled recording's first frame, with the poses that the pipeline found in it.
void reconstruct(benchmark::State& state, const char* name, bool whole_view) {
  const Recording recording = load_recording(std::filesystem::path(DIMINISH_RECORDINGS_DIR) / name);
  const Options options;
  FrameSet frame;
  DiminishedFrame result;
  open_recording(recording, options)->next(frame);
  Pipeline(recording.rig, recording.scene, options).process(frame, result);
  const DepthImages depths = testing::depths_of(frame);
  const OcclusionMasks masks = testing::empty_masks(recording.rig);
  const Rect region = whole_view ? recording.rig.color.bounds() : result.reconstruction.region;
  const auto fast = Registry<Reconstructor>::get("cpu")(recording.rig);
  const auto plain = Registry<Reconstructor>::get("reference")(recording.rig);
  Reconstruction reconstruction;
  const auto run = [&](Reconstructor& reconstructor) {
    reconstructor.reconstruct(frame, depths, result.report.poses, masks, region, options,
                              reconstruction);
  };
  run_beside_peer(
      state, [&] { run(*fast); }, [&] { run(*plain); });
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
