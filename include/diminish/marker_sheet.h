#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "diminish/board.h"
#include "diminish/export.h"

namespace diminish {

/// Square markers to print.
struct MarkerSheet {
  std::string dictionary = "DICT_4X4_50";
  std::vector<int> ids;
  double size_m = 0.1;       ///< side of the black square
  double quiet_modules = 1;  ///< white around a marker, in the marker's own cells
};

/// Paper, upright. `paper` turns it if more fits that way.
struct Paper {
  std::string name;
  double width_mm = 0, height_mm = 0;
};

/// The known papers: A4, A3, letter.
DIMINISH_EXPORT const std::vector<Paper>& papers();

/// Throws Error that lists the known names.
DIMINISH_EXPORT const Paper& find_paper(const std::string& name);

/// Writes the sheet at true size, with id and size below each marker and a ruler to check the
/// print. The file's extension is the format: svg, pdf or png. Markers that do not fit on one page
/// go to further pages, which only PDF has. Throws Error on an unknown dictionary, an id that is
/// not in it, a marker that does not fit on the paper, or a file that cannot be written.
DIMINISH_EXPORT void write_marker_sheet(const MarkerSheet& sheet, const Paper& paper,
                                        const std::filesystem::path& file);

/// The same for a board: one page, with the text that `parse_board` reads below it.
DIMINISH_EXPORT void write_board(const Board& board, const Paper& paper,
                                 const std::filesystem::path& file);

}  // namespace diminish
