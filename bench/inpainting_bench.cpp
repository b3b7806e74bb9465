#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include "beside_peer.h"
#include "core/mat.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

/// Thin holes that cover about `percent` of a picture of 1280x1024.
Mask make_pipes(int percent) {
  Mask mask(1280, 1024, 0);
  cv::Mat mat = as_mat(mask);
  cv::RNG random(2);
  while (cv::countNonZero(mat) * 100 < percent * 1280 * 1024) {
    cv::line(mat, {random.uniform(0, 1280), random.uniform(0, 1024)},
             {random.uniform(0, 1280), random.uniform(0, 1024)}, cv::Scalar(255),
             random.uniform(5, 15));
  }
  return mask;
}

void harmonic_beside_telea(benchmark::State& state) {
  Image<Bgr> picture(1280, 1024);
  cv::RNG(3).fill(as_mat(picture), cv::RNG::UNIFORM, 0, 256);
  const Mask missing = make_pipes(static_cast<int>(state.range(0)));
  const auto inpainter = Registry<Inpainter>::get("harmonic")();
  const Options options;
  run_beside_peer(
      state, [&] { inpainter->inpaint(missing, options, picture); },
      [&] {
        cv::Mat filled;
        cv::inpaint(as_mat(picture), as_mat(missing), filled, 5, cv::INPAINT_TELEA);
      });
}
BENCHMARK(harmonic_beside_telea)
    ->ArgName("percent_missing")
    ->Arg(1)
    ->Arg(5)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
