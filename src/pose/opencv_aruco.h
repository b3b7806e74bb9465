#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/version.hpp>
#include <vector>

// OpenCV's markers. OpenCV 4.7 (Debian 13) moved them to another module and changed their
// interface; Debian 12 and Ubuntu 24.04 have 4.6. What differs stands here, and nowhere else.

#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#define DIMINISH_OPENCV_4_7
#include <opencv2/objdetect/aruco_detector.hpp>
#include <opencv2/objdetect/charuco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#endif

namespace diminish::opencv_aruco {

using Dictionary = cv::Ptr<cv::aruco::Dictionary>;
using Board = cv::Ptr<cv::aruco::CharucoBoard>;
/// By marker.
using Corners = std::vector<std::vector<cv::Point2f>>;

#ifdef DIMINISH_OPENCV_4_7

using DictionaryName = cv::aruco::PredefinedDictionaryType;

inline Dictionary dictionary(DictionaryName name) {
  return cv::makePtr<cv::aruco::Dictionary>(cv::aruco::getPredefinedDictionary(name));
}
inline void draw(const Dictionary& dictionary, int id, int side_px, cv::Mat& drawn) {
  cv::aruco::generateImageMarker(*dictionary, id, side_px, drawn);
}
/// is_refined: corners are refined to parts of a pixel.
inline void detect(const cv::Mat& picture, const Dictionary& dictionary, bool is_refined,
                   Corners& corners, std::vector<int>& ids) {
  cv::aruco::DetectorParameters parameters;
  if (is_refined) parameters.cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::ArucoDetector(*dictionary, parameters).detectMarkers(picture, corners, ids);
}

inline Board make_board(cv::Size squares, float square_m, float marker_m,
                        const Dictionary& dictionary) {
  return cv::makePtr<cv::aruco::CharucoBoard>(squares, square_m, marker_m, *dictionary);
}
inline void draw(const Board& board, cv::Size pixels, cv::Mat& drawn) {
  board->generateImage(pixels, drawn);
}
inline const std::vector<int>& marker_ids(const Board& board) {
  return board->getIds();
}
inline const std::vector<std::vector<cv::Point3f>>& marker_corners(const Board& board) {
  return board->getObjPoints();
}
/// The chessboard's inner corners, by id: on the board, and in a picture.
inline std::vector<cv::Point3f> corners(const Board& board) {
  return board->getChessboardCorners();
}
inline void detect_corners(const cv::Mat& grey, const Board& board,
                           std::vector<cv::Point2f>& pixels, std::vector<int>& ids) {
  cv::aruco::CharucoDetector(*board).detectBoard(grey, pixels, ids);
}

#else

using DictionaryName = cv::aruco::PREDEFINED_DICTIONARY_NAME;

inline Dictionary dictionary(DictionaryName name) {
  return cv::aruco::getPredefinedDictionary(name);
}
inline void draw(const Dictionary& dictionary, int id, int side_px, cv::Mat& drawn) {
  cv::aruco::drawMarker(dictionary, id, side_px, drawn);
}
/// is_refined: corners are refined to parts of a pixel.
inline void detect(const cv::Mat& picture, const Dictionary& dictionary, bool is_refined,
                   Corners& corners, std::vector<int>& ids) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  if (is_refined) parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::detectMarkers(picture, dictionary, corners, ids, parameters);
}

inline Board make_board(cv::Size squares, float square_m, float marker_m,
                        const Dictionary& dictionary) {
  return cv::aruco::CharucoBoard::create(squares.width, squares.height, square_m, marker_m,
                                         dictionary);
}
inline void draw(const Board& board, cv::Size pixels, cv::Mat& drawn) {
  board->draw(pixels, drawn);
}
inline const std::vector<int>& marker_ids(const Board& board) {
  return board->ids;
}
inline const std::vector<std::vector<cv::Point3f>>& marker_corners(const Board& board) {
  return board->objPoints;
}
/// The chessboard's inner corners, by id: on the board, and in a picture.
inline std::vector<cv::Point3f> corners(const Board& board) {
  return board->chessboardCorners;
}
inline void detect_corners(const cv::Mat& grey, const Board& board,
                           std::vector<cv::Point2f>& pixels, std::vector<int>& ids) {
  Corners corners;
  std::vector<int> markers;
  detect(grey, board->dictionary, false, corners, markers);
  if (markers.empty()) return;
  cv::aruco::interpolateCornersCharuco(corners, markers, grey, board, pixels, ids);
}

#endif

}  // namespace diminish::opencv_aruco
