#include "setup/print/board_layout.h"

namespace diminish {

cv::Size board_squares(const Board& board) {
  const int more = board.kind == Board::Kind::checkerboard ? 1 : 0;
  return {board.columns + more, board.rows + more};
}

void add_marker(const MarkerDictionary& dictionary, int id, double x, double y, double size,
                std::vector<Page::Rectangle>& black) {
  const int side = dictionary.side;
  const int cells = side + 2;
  const auto& code = dictionary.codes.at(static_cast<std::size_t>(id));
  const auto is_black = [&](int row, int column) {
    const bool in_border = row == 0 || column == 0 || row == cells - 1 || column == cells - 1;
    return in_border || !code[static_cast<std::size_t>((row - 1) * side + column - 1)];
  };
  const double cell = size / cells;
  for (int row = 0; row < cells; ++row) {
    for (int begin = 0; begin < cells;) {
      int end = begin;
      while (end < cells && is_black(row, end)) ++end;
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
    const MarkerDictionary dictionary = find_dictionary(board.dictionary);
    const double marker = 1000 * board.marker_m;
    for (const CharucoBoard::Place& place : CharucoBoard(board).markers()) {
      const double x = 1000 * place.x_m;
      const double y = 1000 * place.y_m;
      add_marker(dictionary, place.id, x - marker / 2, y - marker / 2, marker, black);
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
