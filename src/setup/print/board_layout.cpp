#include "setup/print/board_layout.h"

#include <fmt/format.h>

#include <cmath>

#include "diminish/error.h"
#include "pose/marker_dictionary.h"

namespace diminish {

cv::Ptr<cv::aruco::CharucoBoard> make_charuco_board(const Board& board) {
  const auto dictionary = find_dictionary(board.dictionary);
  const int markers = board.columns * board.rows / 2;
  if (markers > dictionary->bytesList.rows) {
    throw Error(fmt::format("board '{}': expected a dictionary of at least {} markers, got {}",
                            describe(board), markers, dictionary->bytesList.rows));
  }
  return cv::aruco::CharucoBoard::create(board.columns, board.rows,
                                         static_cast<float>(board.square_m),
                                         static_cast<float>(board.marker_m), dictionary);
}

cv::Size board_squares(const Board& board) {
  const int more = board.kind == Board::Kind::checkerboard ? 1 : 0;
  return {board.columns + more, board.rows + more};
}

void add_marker(const cv::aruco::Dictionary& dictionary, int id, double x, double y, double size,
                std::vector<Page::Rectangle>& black) {
  const int cells = dictionary.markerSize + 2;
  cv::Mat picture;
  // cv::aruco draws at any size; this is one pixel per cell.
  cv::Ptr<cv::aruco::Dictionary> copy(new cv::aruco::Dictionary(dictionary));
  cv::aruco::drawMarker(copy, id, cells, picture, 1);
  const double cell = size / cells;
  for (int row = 0; row < cells; ++row) {
    for (int begin = 0; begin < cells;) {
      int end = begin;
      while (end < cells && picture.at<std::uint8_t>(row, end) == 0) ++end;
      if (end > begin) {
        black.push_back({x + begin * cell, y + row * cell, (end - begin) * cell, cell});
      }
      begin = end + 1;
    }
  }
}

std::vector<Page::Rectangle> board_drawing(const Board& board) {
  const cv::Size squares = board_squares(board);
  const double square = 1000 * board.square_m;
  cv::Mat white(squares, CV_8U, cv::Scalar(0));
  std::vector<Page::Rectangle> black;
  if (board.kind == Board::Kind::charuco) {
    // OpenCV versions differ in which squares hold markers. This is what our version detects.
    const auto charuco = make_charuco_board(board);
    const double marker = 1000 * board.marker_m;
    for (std::size_t i = 0; i < charuco->ids.size(); ++i) {
      const auto& corners = charuco->objPoints[i];
      const cv::Point3f center = 0.25F * (corners[0] + corners[1] + corners[2] + corners[3]);
      const bool y_upwards = corners[0].y > corners[3].y;
      const double x = 1000 * center.x;
      const double y = y_upwards ? squares.height * square - 1000 * center.y : 1000 * center.y;
      add_marker(*charuco->dictionary, charuco->ids[i], x - marker / 2, y - marker / 2, marker,
                 black);
      white.at<std::uint8_t>(static_cast<int>(y / square), static_cast<int>(x / square)) = 1;
    }
  } else {
    for (int row = 0; row < squares.height; ++row) {
      for (int column = 0; column < squares.width; ++column) {
        white.at<std::uint8_t>(row, column) = (row + column) % 2 == 1 ? 1 : 0;
      }
    }
  }
  for (int row = 0; row < squares.height; ++row) {
    for (int column = 0; column < squares.width; ++column) {
      if (white.at<std::uint8_t>(row, column) != 0) continue;
      black.push_back({column * square, row * square, square, square});
    }
  }
  return black;
}

}  // namespace diminish
