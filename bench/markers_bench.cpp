#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "beside_peer.h"
#include "core/mat.h"
#include "diminish/marker_detector.h"
#include "diminish/rig.h"
#include "paths.h"
#include "pose/opencv_aruco.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;

struct Picture {
  Image<Bgr> image;
  std::vector<Marker> truth;  ///< empty if unknown
};

/// How many of the existing markers a detector found.
struct Found {
  std::size_t wanted = 0, found = 0, wrong = 0;
  double squares = 0;

  void count(const Picture& picture, const std::vector<Marker>& markers) {
    wanted += picture.truth.size();
    for (const Marker& marker : markers) {
      bool right = false;
      for (const Marker& truth : picture.truth) {
        if (truth.id != marker.id || (truth.corners[0] - marker.corners[0]).norm() > 8) continue;
        right = true;
        for (std::size_t c = 0; c < 4; ++c) {
          squares += (truth.corners[c] - marker.corners[c]).squaredNorm();
        }
      }
      ++(right ? found : wrong);
    }
  }
  double rms_px() const { return std::sqrt(squares / (8.0 * static_cast<double>(found))); }
};

std::vector<Marker> detect_with_opencv(const Image<Bgr>& image,
                                       const opencv_aruco::Dictionary& dictionary) {
  cv::Mat gray;
  cv::cvtColor(as_mat(image), gray, cv::COLOR_BGR2GRAY);
  opencv_aruco::Corners corners;
  std::vector<int> ids;
  opencv_aruco::detect(gray, dictionary, true, corners, ids);
  std::vector<Marker> markers;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Marker marker{ids[i], {}};
    for (std::size_t c = 0; c < 4; ++c) marker.corners[c] = {corners[i][c].x, corners[i][c].y};
    markers.push_back(marker);
  }
  return markers;
}

void beside_opencv(benchmark::State& state, const std::vector<Picture>& pictures,
                   const std::string& name, opencv_aruco::DictionaryName id) {
  if (pictures.empty()) {
    state.SkipWithError("no pictures");
    return;
  }
  const auto dictionary = opencv_aruco::dictionary(id);
  MarkerDetector detector(name);
  Found ours;
  Found opencvs;
  std::vector<Marker> markers;
  for (const Picture& picture : pictures) {
    detector.detect(picture.image, Lens(Intrinsics{0, 0, 1000, 1000, 0, 0, {}}), markers);
    ours.count(picture, markers);
    opencvs.count(picture, detect_with_opencv(picture.image, dictionary));
  }
  std::size_t next = 0;
  std::size_t peers_next = 0;
  run_beside_peer(
      state,
      [&] {
        const Image<Bgr>& image = pictures[next++ % pictures.size()].image;
        detector.detect(image, Lens(Intrinsics{0, 0, 1000, 1000, 0, 0, {}}), markers);
      },
      [&] { detect_with_opencv(pictures[peers_next++ % pictures.size()].image, dictionary); });
  if (ours.wanted == 0) {  // no truth to compare with
    state.counters["markers"] = static_cast<double>(ours.wrong);
  } else {
    state.counters["there"] = static_cast<double>(ours.wanted);
    state.counters["found"] = static_cast<double>(ours.found);
    state.counters["wrong"] = static_cast<double>(ours.wrong);
    state.counters["peer_found"] = static_cast<double>(opencvs.found);
    state.counters["rms_px"] = ours.rms_px();
    state.counters["peer_rms_px"] = opencvs.rms_px();
  }
}

/// The calendar's pictures, in turn: one camera's share of a frame. Without truth.
void markers_of_a_frame(benchmark::State& state) {
  const fs::path folder = fs::path(testing::recordings_dir()) / "calendar";
  std::vector<Picture> pictures(2);
  copy_from(cv::imread((folder / "color/000000.jpg").string()), pictures[0].image);
  copy_from(cv::imread((folder / "rgbd0/color/000000.jpg").string()), pictures[1].image);
  beside_opencv(state, pictures, "DICT_4X4_50", cv::aruco::DICT_4X4_50);
}
BENCHMARK(markers_of_a_frame)->UseManualTime()->Unit(benchmark::kMillisecond);

/// DIMINISH_MARKERS may name a folder of pictures WIDTH_aro_*.png and WIDTH_t36_*.png with the true
/// corners beside them (one line per marker: id and four corners).
void markers_with_truth(benchmark::State& state, const char* kind, const char* name,
                        opencv_aruco::DictionaryName id) {
  std::vector<Picture> pictures;
  if (const char* folder = std::getenv("DIMINISH_MARKERS")) {
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().filename().string().starts_with(kind) &&
          entry.path().extension() == ".png") {
        paths.push_back(entry.path());
      }
    }
    std::sort(paths.begin(), paths.end());
    for (fs::path path : paths) {
      Picture picture;
      copy_from(cv::imread(path.string()), picture.image);
      std::ifstream lines(path.replace_extension(".txt"));
      double marker_id = 0;
      while (lines >> marker_id) {
        Marker marker{static_cast<int>(marker_id), {}};
        for (Eigen::Vector2d& corner : marker.corners) lines >> corner.x() >> corner.y();
        picture.truth.push_back(marker);
      }
      pictures.push_back(std::move(picture));
    }
  }
  beside_opencv(state, pictures, name, id);
}
#define DIMINISH_MARKERS_BENCHMARK(kind, dictionary)                                          \
  BENCHMARK_CAPTURE(markers_with_truth, of_##kind, #kind, #dictionary, cv::aruco::dictionary) \
      ->UseManualTime()                                                                       \
      ->Unit(benchmark::kMillisecond)
DIMINISH_MARKERS_BENCHMARK(1280_aro, DICT_ARUCO_ORIGINAL);
DIMINISH_MARKERS_BENCHMARK(1280_t36, DICT_APRILTAG_36h11);
DIMINISH_MARKERS_BENCHMARK(1920_aro, DICT_ARUCO_ORIGINAL);
DIMINISH_MARKERS_BENCHMARK(1920_t36, DICT_APRILTAG_36h11);

}  // namespace
}  // namespace diminish
