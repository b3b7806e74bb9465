#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>
#include <string>

#include "core/mat.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "paths.h"

namespace diminish {
namespace {

/// A camera's picture and intrinsics at another size.
void scale(double factor, Intrinsics& intrinsics, Image<Bgr>& image) {
  cv::Mat scaled;
  cv::resize(as_mat(image), scaled, {}, factor, factor,
             factor < 1 ? cv::INTER_AREA : cv::INTER_CUBIC);
  copy_from(scaled, image);
  intrinsics.width = image.width();
  intrinsics.height = image.height();
  intrinsics.fx *= factor;
  intrinsics.fy *= factor;
  intrinsics.cx = (intrinsics.cx + 0.5) * factor - 0.5;
  intrinsics.cy = (intrinsics.cy + 0.5) * factor - 0.5;
}

/// Whole frames of a bundled recording with colour pictures of another size (the first argument, in
/// percent) and with its RGB-D camera repeated (the second).
void scaling(benchmark::State& state) {
  Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar");
  FrameSet frame;
  open_recording(recording, {})->next(frame);
  Rig& rig = recording.rig;
  scale(static_cast<double>(state.range(0)) / 100, rig.color, frame.color.own());
  for (int k = 1; k < state.range(1); ++k) {
    rig.rgbd.push_back(rig.rgbd.front());
    rig.rgbd.back().name = "rgbd" + std::to_string(k);
    frame.rgbd.push_back(frame.rgbd.front());
  }
  Pipeline pipeline(rig, recording.scene, {});
  DiminishedFrame result;
  for (auto _ : state) pipeline.process(frame, result);
  state.counters["width"] = rig.color.width;
  state.counters["height"] = rig.color.height;
  state.counters["rgbd_cameras"] = static_cast<double>(state.range(1));
  state.counters["mask_pixels"] = static_cast<double>(result.report.mask_pixels);
}
BENCHMARK(scaling)
    ->ArgsProduct({{50, 100, 200}, {1, 2, 4}})
    ->UseRealTime()
    ->MinTime(2)
    ->Unit(benchmark::kMillisecond);

/// Whole frames of a bundled recording whose objects all stay in the picture (the argument: which
/// one): what a frame costs in which there is nothing to remove.
void without_objects(benchmark::State& state) {
  constexpr const char* names[] = {"calendar", "ball", "workbench"};
  const char* const name = names[state.range(0)];
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / name);
  FrameSet frame;
  open_recording(recording, {})->next(frame);
  Options options;
  for (const OccluderSpec& object : recording.scene.occluders) options.keep += object.name + ",";
  Pipeline pipeline(recording.rig, recording.scene, options);
  DiminishedFrame result;
  for (auto _ : state) pipeline.process(frame, result);
  state.SetLabel(name);
  state.counters["poses_ms"] = result.report.milliseconds[static_cast<std::size_t>(Stage::poses)];
  state.counters["mask_pixels"] = static_cast<double>(result.report.mask_pixels);
}
BENCHMARK(without_objects)->DenseRange(0, 2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
