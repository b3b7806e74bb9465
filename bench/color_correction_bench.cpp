#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>
#include <string>

#include "beside_peer.h"
#include "core/mat.h"
#include "diminish/color_corrector.h"

namespace diminish {
namespace {

enum Shape { rectangle, quad, disc };

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
      destination = (destination - cv::Scalar::all(110)) * 6 + cv::Scalar::all(20);
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
    if (shape == rectangle) mask(cv::Rect(400, 300, 400, 300)).setTo(255);
    if (shape == quad) {
      const cv::Point corners[] = {{380, 250}, {880, 300}, {840, 720}, {330, 660}};
      cv::fillConvexPoly(mask, corners, 4, cv::Scalar(255));
    }
    if (shape == disc) cv::circle(mask, {640, 512}, 150, cv::Scalar(255), cv::FILLED);
    picture = camera;
    colors_only = source;
  }

  Image<Bgr> camera, picture;
  Mask occlusion;
  Reconstruction reconstruction;
  cv::Mat colors_only;
};

void poisson_beside_seamless_clone(benchmark::State& state, Shape shape) {
  Cloning cloning(shape);
  const auto corrector = Registry<ColorCorrector>::get("poisson")();
  const Rect box = bounding_box(cloning.occlusion);
  const cv::Point center(box.x + box.width / 2, box.y + box.height / 2);
  run_beside_peer(
      state,
      [&] {
        corrector->correct(cloning.camera, cloning.occlusion, cloning.reconstruction,
                           cloning.picture);
      },
      [&] {
        cv::Mat cloned;
        cv::seamlessClone(cloning.colors_only, as_mat(cloning.camera), as_mat(cloning.occlusion),
                          center, cloned, cv::NORMAL_CLONE);
      });
}
BENCHMARK_CAPTURE(poisson_beside_seamless_clone, rectangle_400x300, rectangle)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(poisson_beside_seamless_clone, quad_15_percent, quad)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(poisson_beside_seamless_clone, disc_radius_150, disc)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
