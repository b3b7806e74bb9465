#pragma once

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/core.hpp>
#include <vector>

#include "diminish/board.h"
#include "setup/print/page.h"

namespace diminish {

/// The board as OpenCV knows it. Throws Error if its dictionary is unknown, or too small for it.
cv::Ptr<cv::aruco::CharucoBoard> make_charuco_board(const Board& board);

/// Squares along the width and the height.
cv::Size board_squares(const Board& board);

/// The black of a marker's cells: runs of cells, row by row. (x, y): its top left.
void add_marker(const cv::aruco::Dictionary& dictionary, int id, double x, double y, double size,
                std::vector<Page::Rectangle>& black);

/// The board's black, in millimetres from its top left.
std::vector<Page::Rectangle> board_drawing(const Board& board);

}  // namespace diminish
