#include "diminish/board.h"

#include <fmt/format.h>

#include <vector>

#include "core/text.h"
#include "diminish/error.h"
#include "pose/aruco.h"

namespace diminish {
namespace {

constexpr const char* expectation =
    "expected charuco:COLUMNSxROWS:SQUARE_MM:MARKER_MM[:DICTIONARY] or "
    "checkerboard:COLUMNSxROWS:SQUARE_MM";

[[noreturn]] void fail(const std::string& text, const std::string& what) {
  throw Error(fmt::format("board '{}': {}", printable(text), what));
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

int read_count(const std::string& text, const std::string& part, int least) {
  const auto number = parse_number(part);
  constexpr int most = 50;
  if (!number || *number != static_cast<int>(*number) || *number < least || *number > most) {
    fail(text, fmt::format("expected from {} to {} columns and rows, got '{}'", least, most,
                           printable(part)));
  }
  return static_cast<int>(*number);
}

double read_metres(const std::string& text, const std::string& part) {
  const auto millimetres = parse_number(part);
  if (!millimetres || *millimetres < 1 || *millimetres > 2000) {
    fail(text, fmt::format("expected from 1 to 2000 millimetres, got '{}'", printable(part)));
  }
  return *millimetres / 1000;
}

}  // namespace

Board parse_board(const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  Board board;
  const bool charuco = parts[0] == "charuco";
  if (!charuco && parts[0] != "checkerboard") fail(text, expectation);
  if (charuco ? parts.size() < 4 || parts.size() > 5 : parts.size() != 3) fail(text, expectation);
  board.kind = charuco ? Board::Kind::charuco : Board::Kind::checkerboard;
  const std::vector<std::string> size = split(parts[1], 'x');
  if (size.size() != 2) fail(text, expectation);
  board.columns = read_count(text, size[0], 3);
  board.rows = read_count(text, size[1], 3);
  board.square_m = read_metres(text, parts[2]);
  if (!charuco) return board;
  board.marker_m = read_metres(text, parts[3]);
  if (!(board.marker_m < board.square_m)) fail(text, "expected markers smaller than the squares");
  board.dictionary = parts.size() == 5 ? parts[4] : "DICT_4X4_50";
  CharucoBoard{board};  // throws Error
  return board;
}

std::string describe(const Board& board) {
  const double square_mm = 1000 * board.square_m;
  if (board.kind == Board::Kind::checkerboard) {
    return fmt::format("checkerboard:{}x{}:{:.6g}", board.columns, board.rows, square_mm);
  }
  return fmt::format("charuco:{}x{}:{:.6g}:{:.6g}:{}", board.columns, board.rows, square_mm,
                     1000 * board.marker_m, board.dictionary);
}

}  // namespace diminish
