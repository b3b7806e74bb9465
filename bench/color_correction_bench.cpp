#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>
#include <string>

#include "beside_peer.h"
#include "core/channels.h"
#include "core/mat.h"
#include "diminish/color_corrector.h"
#include "laplace_equation.h"
#include "picture_difference.h"

namespace diminish {
namespace {

enum Shape { rectangle, quad, disc, whole };

/// A reconstruction of another exposure than the camera's picture, and a mask. DIMINISH_STAGE_DATA
/// may name a folder with photo_aloe.png and src.png to use instead of made ones.
struct Cloning {
  explicit Cloning(Shape shape) : occlusion(1280, 1024, 0) {
    const char* folder = std::getenv("DIMINISH_STAGE_DATA");
    cv::Mat destination;
    cv::Mat source;
    if (folder) {
      destination = cv::imread(std::string(folder) + "/photo_aloe.png");
      source = cv::imread(std::string(folder) + "/src.png");
    }
    if (destination.size() != cv::Size(1280, 1024) || source.size() != destination.size()) {
      destination.create(1024, 1280, CV_8UC3);
      cv::RNG random(1);
      random.fill(destination, cv::RNG::UNIFORM, 0, 256);
      cv::GaussianBlur(destination, destination, {}, 4);
      destination.convertTo(destination, -1, 6, -640);
      destination.convertTo(source, -1, 0.8, 25);
    }
    copy_from(destination, camera);
    reconstruction.region = camera.bounds();
    reconstruction.color.resize(1280, 1024);
    cv::Mat colors = as_mat(reconstruction.color);
    cv::cvtColor(source, colors, cv::COLOR_BGR2BGRA);
    reconstruction.depth_m.resize(1280, 1024, 1.F);
    reconstruction.source.resize(1280, 1024, 1);
    cv::Mat mask = as_mat(occlusion);
    if (folder) {
      const char* const names[] = {"a_rect", "b_quad", "c_disc", "d_full"};
      const cv::Mat given =
          cv::imread(std::string(folder) + "/mask_" + names[shape] + ".png", cv::IMREAD_GRAYSCALE);
      if (given.size() == mask.size()) given.copyTo(mask);
    }
    if (shape == whole) mask.setTo(255);
    // The picture's border is known.
    cv::rectangle(mask, cv::Rect(0, 0, 1280, 1024), cv::Scalar(0));
    if (cv::countNonZero(mask) == 0) draw(shape, mask);
    picture = camera;
    colors_only = source;
  }

  static void draw(Shape shape, cv::Mat& mask) {
    if (shape == rectangle) mask(cv::Rect(400, 300, 400, 300)).setTo(255);
    if (shape == quad) {
      const cv::Point corners[] = {{380, 250}, {880, 300}, {840, 720}, {330, 660}};
      cv::fillConvexPoly(mask, corners, 4, cv::Scalar(255));
    }
    if (shape == disc) cv::circle(mask, {640, 512}, 150, cv::Scalar(255), cv::FILLED);
  }

  Image<Bgr> camera, picture;
  Mask occlusion;
  Reconstruction reconstruction;
  cv::Mat colors_only;
};

/// Beside cv::seamlessClone. rms: against the exact result; both rounded. Not of the whole picture:
/// a direct solve of a million equations takes gigabytes.
void poisson_beside_seamless_clone(benchmark::State& state, Shape shape) {
  Cloning cloning(shape);
  const auto corrector = Registry<ColorCorrector>::get("poisson")();
  const Rect box = bounding_box(cloning.occlusion);
  const cv::Point center(box.x + box.width / 2, box.y + box.height / 2);
  const auto correct = [&] {
    corrector->correct({cloning.camera, cloning.occlusion, cloning.reconstruction, {}},
                       cloning.picture);
  };
  correct();  // memory grows to its size
  run_beside_peer(state, correct, [&] {
    cv::Mat cloned;
    cv::seamlessClone(cloning.colors_only, as_mat(cloning.camera), as_mat(cloning.occlusion),
                      center, cloned, cv::NORMAL_CLONE);
  });
  if (shape == whole) return;
  const Image<Eigen::Array3d> result =
      testing::exact_cloning(cloning.camera, cloning.reconstruction.color, cloning.occlusion,
                             cloning.reconstruction.source);
  Image<Bgr> exact = cloning.camera;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (cloning.occlusion.data()[i] != 0)
      exact.data()[i] = to_color(result.data()[i].cast<float>());
  }
  state.counters["rms"] =
      std::sqrt(testing::mean_squared_difference(cloning.picture, exact, cloning.occlusion));
}
#define DIMINISH_CLONING_BENCHMARK(name, shape)                 \
  BENCHMARK_CAPTURE(poisson_beside_seamless_clone, name, shape) \
      ->UseManualTime()                                         \
      ->Unit(benchmark::kMillisecond)
DIMINISH_CLONING_BENCHMARK(rectangle_400x300, rectangle);
DIMINISH_CLONING_BENCHMARK(quad_15_percent, quad);
DIMINISH_CLONING_BENCHMARK(disc_radius_150, disc);
// The peer takes half a minute.
DIMINISH_CLONING_BENCHMARK(whole_image, whole)->Iterations(1);

}  // namespace
}  // namespace diminish
