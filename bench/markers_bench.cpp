#include <opencv2/aruco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "beside_peer.h"
#include "core/mat.h"
#include "diminish/error.h"
#include "diminish/marker_detector.h"
#include "diminish/rig.h"

namespace diminish {
namespace {

/// OpenCV's own sub-pixel refinement beside ours, on the calendar's first picture.
void markers_beside_opencv(benchmark::State& state) {
  const std::filesystem::path folder = std::filesystem::path(DIMINISH_RECORDINGS_DIR) / "calendar";
  const Lens lens(load_rig(folder / "rig.yaml").color);
  Image<Bgr> image;
  copy_from(cv::imread((folder / "color/000000.jpg").string()), image);
  MarkerDetector detector("DICT_4X4_50");
  std::vector<Marker> markers;
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  run_beside_peer(
      state, [&] { detector.detect(image, lens, markers); },
      [&] {
        cv::Mat gray;
        cv::cvtColor(as_mat(image), gray, cv::COLOR_BGR2GRAY);
        std::vector<std::vector<cv::Point2f>> corners;
        std::vector<int> ids;
        cv::aruco::detectMarkers(gray, dictionary, corners, ids, parameters);
      });
  state.counters["markers"] = static_cast<double>(markers.size());
}
BENCHMARK(markers_beside_opencv)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace diminish
