#include "diminish/marker_detector.h"

#include <algorithm>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/mat.h"
#include "diminish/error.h"
#include "pose/corner_refinement.h"

namespace diminish {
namespace {

using DictionaryName = std::pair<const char*, cv::aruco::PREDEFINED_DICTIONARY_NAME>;
#define DIMINISH_DICTIONARY(name) \
  DictionaryName {                \
#name, cv::aruco::name        \
  }
constexpr DictionaryName dictionaries[] = {
    DIMINISH_DICTIONARY(DICT_4X4_50),         DIMINISH_DICTIONARY(DICT_4X4_100),
    DIMINISH_DICTIONARY(DICT_4X4_250),        DIMINISH_DICTIONARY(DICT_4X4_1000),
    DIMINISH_DICTIONARY(DICT_5X5_50),         DIMINISH_DICTIONARY(DICT_5X5_100),
    DIMINISH_DICTIONARY(DICT_5X5_250),        DIMINISH_DICTIONARY(DICT_5X5_1000),
    DIMINISH_DICTIONARY(DICT_6X6_50),         DIMINISH_DICTIONARY(DICT_6X6_100),
    DIMINISH_DICTIONARY(DICT_6X6_250),        DIMINISH_DICTIONARY(DICT_6X6_1000),
    DIMINISH_DICTIONARY(DICT_7X7_50),         DIMINISH_DICTIONARY(DICT_7X7_100),
    DIMINISH_DICTIONARY(DICT_7X7_250),        DIMINISH_DICTIONARY(DICT_7X7_1000),
    DIMINISH_DICTIONARY(DICT_ARUCO_ORIGINAL), DIMINISH_DICTIONARY(DICT_APRILTAG_16h5),
    DIMINISH_DICTIONARY(DICT_APRILTAG_25h9),  DIMINISH_DICTIONARY(DICT_APRILTAG_36h10),
    DIMINISH_DICTIONARY(DICT_APRILTAG_36h11)};
#undef DIMINISH_DICTIONARY

cv::Ptr<cv::aruco::Dictionary> find_dictionary(const std::string& name) {
  std::string known;
  for (const auto& [candidate, id] : dictionaries) {
    if (name == candidate) return cv::aruco::getPredefinedDictionary(id);
    known += (known.empty() ? "" : ", ") + std::string(candidate);
  }
  throw Error("marker_dictionary: expected one of " + known + ", got '" + name + "'");
}

/// Removes every marker whose id occurs more than once. `markers` is sorted by id.
void remove_ambiguous(std::vector<Marker>& markers) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < markers.size();) {
    std::size_t next = i + 1;
    while (next < markers.size() && markers[next].id == markers[i].id) ++next;
    if (next == i + 1) markers[kept++] = markers[i];
    i = next;
  }
  markers.resize(kept);
}

}  // namespace

struct MarkerDetector::Implementation {
  cv::Ptr<cv::aruco::Dictionary> dictionary;
  cv::Ptr<cv::aruco::DetectorParameters> parameters = cv::aruco::DetectorParameters::create();
  Image<std::uint8_t> gray;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
};

MarkerDetector::MarkerDetector(const std::string& dictionary)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->dictionary = find_dictionary(dictionary);
  implementation_->parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
}
MarkerDetector::~MarkerDetector() = default;
MarkerDetector::MarkerDetector(MarkerDetector&&) noexcept = default;
MarkerDetector& MarkerDetector::operator=(MarkerDetector&&) noexcept = default;

void MarkerDetector::detect(const Image<Bgr>& image, const Lens& lens,
                            std::vector<Marker>& markers) {
  Implementation& self = *implementation_;
  markers.clear();
  self.gray.resize(image.width(), image.height());
  cv::Mat gray = as_mat(self.gray);
  cv::cvtColor(as_mat(image), gray, cv::COLOR_BGR2GRAY);
  cv::aruco::detectMarkers(gray, self.dictionary, self.corners, self.ids, self.parameters);
  const int modules = self.dictionary->markerSize + 2;
  for (std::size_t i = 0; i < self.ids.size(); ++i) {
    Marker marker{self.ids[i], {}};
    for (std::size_t c = 0; c < 4; ++c) {
      marker.corners[c] = {self.corners[i][c].x, self.corners[i][c].y};
    }
    refine_corners(self.gray, lens, modules, marker.corners);
    markers.push_back(marker);
  }
  std::sort(markers.begin(), markers.end(),
            [](const Marker& a, const Marker& b) { return a.id < b.id; });
  remove_ambiguous(markers);
}

}  // namespace diminish
