#include <benchmark/benchmark.h>

#include <opencv2/imgcodecs.hpp>

#include "beside_peer.h"
#include "core/mat.h"
#include "diminish/frame_source.h"
#include "diminish/options.h"
#include "paths.h"
#include "ros/depth_codec.h"

namespace diminish {
namespace {

Image<std::uint16_t> depth_of(const char* recording) {
  FrameSet frame;
  open_recording(load_recording(std::filesystem::path(testing::recordings_dir()) / recording),
                 Options())
      ->next(frame);
  Image<std::uint16_t> depth;
  copy(frame.rgbd[0].depth.view(), depth);
  return depth;
}

constexpr const char* recordings[] = {"calendar", "ball", "workbench"};

void sizes(benchmark::State& state, const Image<std::uint16_t>& depth,
           const std::vector<std::uint8_t>& ours, const std::vector<std::uint8_t>& png) {
  state.counters["pixels"] = static_cast<double>(depth.size());
  state.counters["bytes"] = static_cast<double>(ours.size());
  state.counters["png_bytes"] = static_cast<double>(png.size());
}

/// Beside OpenCV's PNG at its fastest level.
void compressing(benchmark::State& state) {
  const auto depth = depth_of(recordings[state.range(0)]);
  std::vector<std::uint8_t> ours, png;
  run_beside_peer(
      state,
      [&] {
        ours.clear();
        ros::compress_depth(depth, ours);
      },
      [&] {
        cv::imencode(".png", as_mat(depth), png, {cv::IMWRITE_PNG_COMPRESSION, 1});
      });
  sizes(state, depth, ours, png);
}

void decompressing(benchmark::State& state) {
  const auto depth = depth_of(recordings[state.range(0)]);
  std::vector<std::uint8_t> ours, png;
  ros::compress_depth(depth, ours);
  cv::imencode(".png", as_mat(depth), png, {cv::IMWRITE_PNG_COMPRESSION, 1});
  Image<std::uint16_t> back(depth.width(), depth.height());
  run_beside_peer(
      state, [&] { ros::decompress_depth(ours, back); },
      [&] { benchmark::DoNotOptimize(cv::imdecode(png, cv::IMREAD_UNCHANGED)); });
  sizes(state, depth, ours, png);
}

BENCHMARK(compressing)
    ->Name("depth/compress")
    ->DenseRange(0, 2)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(decompressing)
    ->Name("depth/decompress")
    ->DenseRange(0, 2)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
