#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "diminish/inpainter.h"

namespace diminish {

/// Continues straight edges through what is to be invented. An edge that enters the mask on two
/// sides joins both ends. Another runs on as long as its own length makes likely, on one plane and
/// through unseen pixels only; but not the edge of a thing that was measured: such a thing would
/// have been seen further inside, too.
class LinePainting {
 public:
  /// Draws `holes.lines` into the missing pixels of `picture`, which are filled smoothly already.
  /// Changes no other pixel. Cost: a few operations for each pixel beside a line.
  void paint(const Holes& holes, const Rect& objects, Image<Bgr>& picture);

 private:
  /// Colours across a stroke, in four channels for the sake of vector instructions.
  using Profile = std::array<Eigen::Array4f, RimLine::profile_size>;
  /// A line, or two that meet, through the mask.
  struct Stroke {
    const RimLine* begin;
    const RimLine* end;  ///< null: it just ends
    Eigen::Vector2f start, along, normal;
    float length;
    bool has_company = false;  ///< others run beside it
    Profile begin_colors{}, end_colors{};
  };
  /// Of the stroke that is nearest to a pixel.
  struct Claim {
    float distance;
    bool is_between;  ///< two that run side by side: inside a pipe
  };

  static Profile colors_of(const RimLine& line, bool joins);
  void match(std::span<const RimLine> lines);
  void lay_out(const Holes& holes);
  float free_length(const RimLine& line, const Holes& holes) const;
  static bool are_company(const Stroke& a, const Stroke& b);
  template <class Visit>
  static void for_each_beside(const Stroke& stroke, float width, const Rect& part,
                              const Mask& missing, const Visit& visit);
  void claim(const Mask& missing, const Surfaces& surfaces, const Rect& part);
  void color(int column, int row, Bgr& pixel) const;

  struct Pair {
    float misfit;
    int first, second;
  };
  std::vector<Pair> pairs_;
  std::vector<int> mates_;
  std::vector<Stroke> strokes_;
  // Of the objects' box:
  Image<std::uint8_t> nearest_;  ///< 1 + the stroke's index; 0: none is near
  Image<Claim> claims_;          ///< where one is
  Rect objects_;
};

}  // namespace diminish
