#pragma once

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/core.hpp>
#include <vector>

#include "diminish/board.h"
#include "setup/print/page.h"

namespace diminish {

/// The board as an OpenCV object. Throws Error if its dictionary is unknown or too small for it.
cv::Ptr<cv::aruco::CharucoBoard> make_charuco_board(const Board& board);

/// The number of squares along the width and the height.
cv::Size board_squares(const Board& board);

/// A marker's black cells: runs of cells, row by row. (x, y): its top left corner.
void add_marker(const cv::aruco::Dictionary& dictionary, int id, double x, double y, double size,
                std::vector<Page::Rectangle>& black);

/// The board's black parts, in millimetres from its top left corner.
std::vector<Page::Rectangle> board_drawing(const Board& board);

}  // namespace diminish
