#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>
#include <string>

#include "beside_peer.h"
#include "core/channels.h"
#include "core/mat.h"
#include "diminish/inpainter.h"
#include "laplace_equation.h"
#include "picture_difference.h"

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

/// exact_psnr: of the exact harmonic filling.
void beside_telea(benchmark::State& state, const char* method, const Image<Bgr>& truth,
                  const Mask& missing) {
  Image<Bgr> picture = truth;
  picture.fill({});
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      if (missing(x, y) == 0) picture(x, y) = truth(x, y);
    }
  }
  Image<Bgr> ours = picture;
  Image<Bgr> exact = picture;
  Image<Bgr> teleas;
  const auto inpainter = Registry<Inpainter>::get(method)();
  const Options options;
  cv::Mat filled;
  run_beside_peer(
      state,
      [&] {
        inpainter->inpaint({missing, missing, {}}, options, ours);
      },
      [&] { cv::inpaint(as_mat(picture), as_mat(missing), filled, 5, cv::INPAINT_TELEA); });
  copy_from(filled, teleas);
  const Image<Eigen::Array3d> filling = testing::exact_filling(picture, missing);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (missing.data()[i] != 0) exact.data()[i] = to_color(filling.data()[i].cast<float>());
  }
  state.counters["missing"] = static_cast<double>(count_nonzero(missing, missing.bounds()));
  state.counters["psnr"] = testing::psnr_db(ours, truth, missing);
  state.counters["exact_psnr"] = testing::psnr_db(exact, truth, missing);
  state.counters["peer_psnr"] = testing::psnr_db(teleas, truth, missing);
}

void harmonic_in_pipes(benchmark::State& state) {
  Image<Bgr> truth(1280, 1024);
  cv::Mat picture = as_mat(truth);
  cv::RNG(3).fill(picture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(picture, picture, {}, 6);
  beside_telea(state, "harmonic", truth, make_pipes(static_cast<int>(state.range(0))));
}
BENCHMARK(harmonic_in_pipes)
    ->ArgName("percent_missing")
    ->Arg(1)
    ->Arg(5)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

/// DIMINISH_STAGE_DATA may name a folder with photographs photo_*.png and holes hole_*.png.
void in_photograph(benchmark::State& state, const char* method, const char* photo,
                   const char* hole) {
  const char* folder = std::getenv("DIMINISH_STAGE_DATA");
  const auto path = [&](const std::string& name) {
    return std::string(folder ? folder : "") + "/" + name + ".png";
  };
  const cv::Mat picture = cv::imread(path(std::string("photo_") + photo));
  const cv::Mat mask = cv::imread(path(std::string("hole_") + hole), cv::IMREAD_GRAYSCALE);
  if (picture.empty() || mask.size() != picture.size()) {
    state.SkipWithError("no pictures");
    return;
  }
  Image<Bgr> truth;
  copy_from(picture, truth);
  Mask missing;
  copy_from(mask, missing);
  beside_telea(state, method, truth, missing);
}
#define DIMINISH_PHOTOGRAPH_BENCHMARK(method, photo, hole)                            \
  BENCHMARK_CAPTURE(in_photograph, method##_##photo##_##hole, #method, #photo, #hole) \
      ->UseManualTime()                                                               \
      ->Unit(benchmark::kMillisecond)
#define DIMINISH_PHOTOGRAPH_BENCHMARKS(method)             \
  DIMINISH_PHOTOGRAPH_BENCHMARK(method, aloe, pipes3);     \
  DIMINISH_PHOTOGRAPH_BENCHMARK(method, garden, pipes3);   \
  DIMINISH_PHOTOGRAPH_BENCHMARK(method, wood, pipes3);     \
  DIMINISH_PHOTOGRAPH_BENCHMARK(method, building, pipes3); \
  DIMINISH_PHOTOGRAPH_BENCHMARK(method, aloe, pipes8);     \
  DIMINISH_PHOTOGRAPH_BENCHMARK(method, aloe, blob200)
DIMINISH_PHOTOGRAPH_BENCHMARKS(harmonic);
DIMINISH_PHOTOGRAPH_BENCHMARKS(surfaces);

}  // namespace
}  // namespace diminish
