#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "diminish/board.h"
#include "pose/aruco.h"
#include "setup/print/page.h"

namespace diminish {

/// The number of squares along the width and the height.
cv::Size board_squares(const Board& board);

/// A marker's black cells: runs of cells, row by row. (x, y): its top left corner.
void add_marker(const MarkerDictionary& dictionary, int id, double x, double y, double size,
                std::vector<Page::Rectangle>& black);

/// The board's black parts, in millimetres from its top left corner.
std::vector<Page::Rectangle> board_drawing(const Board& board);

}  // namespace diminish
