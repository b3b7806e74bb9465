#pragma once

#include <string>

#include "diminish/export.h"

namespace diminish {

/// A calibration board.
struct Board {
  enum class Kind { checkerboard, charuco };

  Kind kind = Kind::charuco;
  /// For charuco the number of squares, for checkerboard the number of inner corners, as OpenCV
  /// counts them.
  int columns = 0, rows = 0;
  double square_m = 0;
  double marker_m = 0;     ///< charuco: side of a marker's black square
  std::string dictionary;  ///< charuco
};

/// Parses "charuco:7x5:30:22:DICT_4X4_50" (squares, square and marker in millimetres, dictionary;
/// default DICT_4X4_50) or "checkerboard:9x6:25" (inner corners, square). Throws Error.
DIMINISH_EXPORT Board parse_board(const std::string& text);

/// The text that `parse_board` reads.
DIMINISH_EXPORT std::string describe(const Board& board);

}  // namespace diminish
