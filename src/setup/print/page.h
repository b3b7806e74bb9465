#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace diminish {

/// A printed page: black rectangles and lines of text on white, in millimetres from its top left
/// corner.
struct Page {
  struct Rectangle {
    double x = 0, y = 0, width = 0, height = 0;
  };
  struct Text {
    double x = 0, y = 0;  ///< where the line begins: its baseline
    double height = 0;    ///< of the font
    std::string text;     ///< ASCII
  };

  double width_mm = 0, height_mm = 0;
  /// The side of a marker's cell, which should be a whole number of pixels in a picture.
  double cell_mm = 1;
  std::vector<Rectangle> black;
  std::vector<Text> texts;
};

std::string page_as_svg(const Page& page);

/// All pages in one file, text in Helvetica.
std::string pages_as_pdf(const std::vector<Page>& pages);

/// Black and white, at about 600 dots per inch, so that a cell is a whole number of pixels. The
/// chunk pHYs gives the resolution.
std::vector<std::uint8_t> page_as_png(const Page& page);

}  // namespace diminish
