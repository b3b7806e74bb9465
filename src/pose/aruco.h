#pragma once

#include <bitset>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "diminish/board.h"
#include "diminish/marker_detector.h"

namespace diminish {

// What we use of OpenCV's markers.

/// The cells of each of a dictionary's markers.
struct MarkerDictionary {
  int side = 0;  ///< cells along a side, without the black border
  /// How many wrong cells a marker may have without being mistaken for another one.
  int correctable_cells = 0;
  std::vector<std::bitset<64>> codes;  ///< by id, row by row; set: white
};

/// A dictionary by OpenCV's name, such as DICT_4X4_50. Throws Error that lists the known names.
MarkerDictionary find_dictionary(const std::string& name);

/// All dictionaries. Among those with the same cells, smaller ones come first.
const std::vector<std::string>& dictionary_names();

/// Detects markers with OpenCV: slower than MarkerDetector, but finds smaller ones. picture: 8-bit
/// grey or BGR. Throws Error for an unknown dictionary.
std::vector<Marker> detect_with_opencv(const cv::Mat& picture, const std::string& dictionary);

/// A chessboard with markers in its white squares. OpenCV versions differ in which squares hold
/// markers; this is what our version detects.
class CharucoBoard {
 public:
  /// Throws Error if the board's dictionary is unknown, or too small for it.
  explicit CharucoBoard(const Board& board);
  ~CharucoBoard();
  CharucoBoard(CharucoBoard&&) noexcept;
  CharucoBoard& operator=(CharucoBoard&&) noexcept;

  struct Place {
    int id;
    double x_m, y_m;  ///< of the marker's centre, from the board's top left
  };
  /// Where the board's markers are.
  std::vector<Place> markers() const;

  /// An inner corner; ids count row by row.
  struct Corner {
    int id;
    cv::Point2f pixel;
  };
  /// The corners that an 8-bit grey picture shows.
  std::vector<Corner> detect(const cv::Mat& grey) const;

 private:
  struct Implementation;
  std::unique_ptr<const Implementation> implementation_;
};

}  // namespace diminish
