#include "diminish/marker_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "diminish/error.h"
#include "pose/aruco.h"
#include "setup/print/board_layout.h"
#include "setup/print/page.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

// Millimetres.
constexpr double page_margin = 10;  ///< printers cannot print there
constexpr double font_height = 3.2;
constexpr double caption_height = 5;
constexpr double ruler_length = 100;
constexpr double ruler_height = 14;
constexpr double between_cells = 2;

Paper turned(const Paper& paper) {
  return {paper.name, paper.height_mm, paper.width_mm};
}

double usable_width(const Paper& paper) {
  return paper.width_mm - 2 * page_margin;
}
double usable_height(const Paper& paper) {
  return paper.height_mm - 2 * page_margin - ruler_height;
}

Page empty_page(const Paper& paper, double cell_mm) {
  Page page{paper.width_mm, paper.height_mm, cell_mm, {}, {}};
  const double bottom = paper.height_mm - page_margin;
  constexpr double line = 0.2;
  page.black.push_back({page_margin, bottom - 6, ruler_length, line});
  for (int mm = 0; mm <= static_cast<int>(ruler_length); ++mm) {
    const double height = mm % 10 == 0 ? 4 : mm % 5 == 0 ? 3 : 1.8;
    page.black.push_back({page_margin + mm - line / 2, bottom - 6 - height, line, height});
  }
  page.texts.push_back({page_margin, bottom - 1, font_height,
                        fmt::format("Print at 100 %, not \"fit to page\". The first and the last "
                                    "mark of this ruler must be {:.0f} mm apart.",
                                    ruler_length)});
  return page;
}

void write_pages(const std::vector<Page>& pages, const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  if (extension == ".pdf") return write_file(file, pages_as_pdf(pages));
  if (extension != ".svg" && extension != ".png") {
    throw Error(file.string() + ": expected a file that ends in .pdf, .svg or .png");
  }
  if (pages.size() > 1) {
    throw Error(fmt::format("{}: the sheet has {} pages, which only a .pdf can hold", file.string(),
                            pages.size()));
  }
  if (extension == ".svg") return write_file(file, page_as_svg(pages.front()));
  const std::vector<std::uint8_t> png = page_as_png(pages.front());
  write_file(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

/// Lays out markers in rows and columns.
struct Grid {
  int columns, rows;

  Grid(const Paper& paper, double cell_width, double cell_height)
      : columns(count(usable_width(paper), cell_width)),
        rows(count(usable_height(paper), cell_height)) {}
  int places() const { return columns * rows; }

 private:
  static int count(double length, double cell) {
    return static_cast<int>(std::floor((length + between_cells) / (cell + between_cells) + 1e-9));
  }
};

}  // namespace

const std::vector<Paper>& papers() {
  static const std::vector<Paper> all = {
      {"A4", 210, 297}, {"A3", 297, 420}, {"letter", 215.9, 279.4}};
  return all;
}

const Paper& find_paper(const std::string& name) {
  std::string known;
  for (const Paper& paper : papers()) {
    if (paper.name == name) return paper;
    known += (known.empty() ? "" : ", ") + paper.name;
  }
  throw Error("page: expected one of " + known + ", got '" + name + "'");
}

void write_marker_sheet(const MarkerSheet& sheet, const Paper& paper,
                        const std::filesystem::path& file) {
  const MarkerDictionary dictionary = find_dictionary(sheet.dictionary);
  const auto markers = static_cast<int>(dictionary.codes.size());
  if (sheet.ids.empty()) throw Error("ids: expected at least one marker");
  for (const int id : sheet.ids) {
    if (id < 0 || id >= markers) {
      throw Error(fmt::format("ids: expected ids of {}, from 0 to {}, got {}", sheet.dictionary,
                              markers - 1, id));
    }
  }
  const double size = 1000 * sheet.size_m;
  if (!(size >= 5)) throw Error(fmt::format("size: expected at least 5 mm, got {:.6g} mm", size));
  const double cell = size / (dictionary.side + 2);
  const double quiet = std::max(0.0, sheet.quiet_modules) * cell;
  const double width = size + 2 * quiet;
  const double height = width + caption_height;

  const Grid upright(paper, width, height);
  const Grid lying(turned(paper), width, height);
  const bool turn = lying.places() > upright.places();
  const Paper used = turn ? turned(paper) : paper;
  const Grid grid = turn ? lying : upright;
  if (grid.places() == 0) {
    const auto largest = [&](const Paper& p) {
      return std::min(usable_width(p), usable_height(p) - caption_height) / width * size;
    };
    throw Error(fmt::format(
        "size: a marker of {:.6g} mm is {:.1f} mm wide with its quiet zone, which {} does not "
        "hold; expected at most {:.0f} mm, or larger paper",
        size, width, paper.name, std::floor(std::max(largest(paper), largest(turned(paper))))));
  }
  std::vector<Page> pages;
  for (std::size_t i = 0; i < sheet.ids.size(); ++i) {
    const auto place = static_cast<int>(i % static_cast<std::size_t>(grid.places()));
    if (place == 0) pages.push_back(empty_page(used, cell));
    const int column = place % grid.columns;
    const int row = place / grid.columns;
    const double x = page_margin + column * (width + between_cells);
    const double y = page_margin + row * (height + between_cells);
    Page& page = pages.back();
    add_marker(dictionary, sheet.ids[i], x + quiet, y + quiet, size, page.black);
    page.texts.push_back(
        {x + quiet, y + width + caption_height - 1.5, std::min(font_height, size / 12),
         fmt::format("{} id {}, {:.6g} mm", sheet.dictionary, sheet.ids[i], size)});
  }
  write_pages(pages, file);
}

void write_board(const Board& board, const Paper& paper, const std::filesystem::path& file) {
  const cv::Size squares = board_squares(board);
  const double square = 1000 * board.square_m;
  const double width = squares.width * square;
  const double height = squares.height * square;
  const auto holds = [&](const Paper& p) {
    return width <= usable_width(p) && height <= usable_height(p);
  };
  const Paper used = holds(paper) ? paper : turned(paper);
  if (!holds(used)) {
    throw Error(
        fmt::format("board '{}': {:.6g} x {:.6g} mm, which {} does not hold; expected "
                    "smaller squares, or larger paper",
                    describe(board), width, height, paper.name));
  }
  const bool charuco = board.kind == Board::Kind::charuco;
  Page page = empty_page(
      used,
      charuco ? 1000 * board.marker_m / (find_dictionary(board.dictionary).side + 2) : square);
  for (Page::Rectangle r : board_drawing(board)) {
    page.black.push_back({r.x + page_margin, r.y + page_margin, r.width, r.height});
  }
  // Beside the ruler.
  page.texts.push_back({page_margin + ruler_length + 5, used.height_mm - page_margin - 7.5,
                        font_height, "--board " + describe(board)});
  write_pages({page}, file);
}

}  // namespace diminish
