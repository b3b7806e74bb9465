#include "pose/aruco.h"

#include <fmt/format.h>

#include <utility>

#include "core/text.h"
#include "diminish/error.h"
#include "pose/opencv_aruco.h"

namespace diminish {
namespace {

using DictionaryName = std::pair<const char*, opencv_aruco::DictionaryName>;
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

opencv_aruco::Dictionary opencv_dictionary(const std::string& name) {
  for (const auto& [candidate, id] : dictionaries) {
    if (name == candidate) return opencv_aruco::dictionary(id);
  }
  throw Error("marker_dictionary: expected one of " + join(dictionary_names()) + ", got '" +
              printable(name) + "'");
}

}  // namespace

const std::vector<std::string>& dictionary_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, id] : dictionaries) all.emplace_back(name);
    return all;
  }();
  return names;
}

MarkerDictionary find_dictionary(const std::string& name) {
  const auto opencv = opencv_dictionary(name);
  MarkerDictionary dictionary{opencv->markerSize, opencv->maxCorrectionBits, {}};
  const int side = dictionary.side;
  for (int id = 0; id < opencv->bytesList.rows; ++id) {
    const cv::Mat cells =
        cv::aruco::Dictionary::getBitsFromByteList(opencv->bytesList.rowRange(id, id + 1), side);
    auto& code = dictionary.codes.emplace_back();
    for (int i = 0; i < side * side; ++i) {
      code[static_cast<std::size_t>(i)] = cells.at<std::uint8_t>(i / side, i % side) != 0;
    }
  }
  return dictionary;
}

std::vector<Marker> detect_with_opencv(const cv::Mat& picture, const std::string& dictionary) {
  opencv_aruco::Corners corners;
  std::vector<int> ids;
  opencv_aruco::detect(picture, opencv_dictionary(dictionary), false, corners, ids);
  std::vector<Marker> markers;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Marker& marker = markers.emplace_back();
    marker.id = ids[i];
    for (std::size_t k = 0; k < 4; ++k) marker.corners[k] = {corners[i][k].x, corners[i][k].y};
  }
  return markers;
}

struct CharucoBoard::Implementation {
  opencv_aruco::Board board;
  double height_m;
};

CharucoBoard::CharucoBoard(const Board& board) {
  const auto dictionary = opencv_dictionary(board.dictionary);
  const int markers = board.columns * board.rows / 2;
  if (markers > dictionary->bytesList.rows) {
    throw Error(fmt::format("board '{}': expected a dictionary of at least {} markers, got {}",
                            describe(board), markers, dictionary->bytesList.rows));
  }
  implementation_ = std::make_unique<const Implementation>(Implementation{
      opencv_aruco::make_board({board.columns, board.rows}, static_cast<float>(board.square_m),
                               static_cast<float>(board.marker_m), dictionary),
      board.rows * board.square_m});
}
CharucoBoard::~CharucoBoard() = default;
CharucoBoard::CharucoBoard(CharucoBoard&&) noexcept = default;
CharucoBoard& CharucoBoard::operator=(CharucoBoard&&) noexcept = default;

std::vector<CharucoBoard::Place> CharucoBoard::markers() const {
  const auto& [board, height_m] = *implementation_;
  std::vector<Place> places;
  const std::vector<int>& ids = opencv_aruco::marker_ids(board);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto& corners = opencv_aruco::marker_corners(board)[i];
    const cv::Point3f center = 0.25F * (corners[0] + corners[1] + corners[2] + corners[3]);
    const bool y_upwards = corners[0].y > corners[3].y;
    const double y_m = y_upwards ? height_m - static_cast<double>(center.y) : center.y;
    places.push_back({ids[i], center.x, y_m});
  }
  return places;
}

std::vector<CharucoBoard::Corner> CharucoBoard::detect(const cv::Mat& grey) const {
  std::vector<cv::Point2f> pixels;
  std::vector<int> ids;
  opencv_aruco::detect_corners(grey, implementation_->board, pixels, ids);
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < ids.size(); ++i) corners.push_back({ids[i], pixels[i]});
  return corners;
}

}  // namespace diminish
