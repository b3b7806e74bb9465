#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "bars/bar.h"
#include "bars/bar_profile.h"
#include "bars/bar_views.h"
#include "diminish/diminished_frame.h"
#include "diminish/image.h"

namespace diminish {

/// Draws bars into the mask, over what is invented and over what an RGB-D camera sees behind them;
/// before, the wall beside them with their shadows, over what is invented: lay_out, then paint.
class BarPainting {
 public:
  struct Input {
    std::span<const Bar> bars;  ///< the surest first
    const BarViews& views;
    const std::vector<BackgroundPlane>& planes;
    ImageView<Bgr> camera;     ///< the user's picture
    const Mask& occlusion;     ///< of the colour camera
    const Surfaces& surfaces;  ///< of the user's picture
    const Reconstruction& drawn;
    const Rect& objects;  ///< its box
  };
  /// Where bars end, and their colours: those that the user's camera sees beside the mask, of both
  /// ends where a bar goes on beyond. A bar ends where it leaves the mask, meets another plane, or
  /// where an RGB-D camera sees what would be behind it. Needs nothing that is invented.
  void lay_out(const Input& input);
  /// Paints them. Changes only picture, provenance and counts of `result`. What stands in front
  /// hides a bar; what the user's camera has seen itself stays. Cost: 30 ns a pixel.
  void paint(const Input& input, DiminishedFrame& result) const;

 private:
  struct Stroke {
    bool is_painted = false;
    float length = 0;                    ///< in the mask
    float end = 0;                       ///< the last place along it
    unsigned labels = 0;                 ///< of what may be behind it, bit by bit
    bool has_far = false;                ///< colours of its other end
    BarProfile near_colors, far_colors;  ///< across it
  };
  /// How much of a place is painted, and in which colour.
  struct Paint {
    float weight = 0;
    Eigen::Array4f color = Eigen::Array4f::Zero();
  };
  /// How far a bar goes on, pixels; and whether it ends only because the mask does.
  struct End {
    float along;
    bool leaves_mask;
  };
  /// How many pixels are estimated now, and how many of them were invented.
  struct Counts {
    std::size_t estimated = 0, inpainted = 0;
  };

  static End find_end(const Input& input, const Bar& bar);
  static void lay_out(const Input& input, const Bar& bar, Stroke& stroke);
  /// The wall beside the bar.
  static Paint beside(const Bar& bar, const Stroke& stroke, const Eigen::Vector2f& at);
  void paint_beside(const Input& input, DiminishedFrame& result) const;
  void paint_beside(const Input& input, int y, DiminishedFrame& result) const;
  static void paint(const Input& input, const Bar& bar, const Stroke& stroke,
                    DiminishedFrame& result);
  /// box: what of the objects' box may show the bar.
  static void paint_row(const Input& input, const Bar& bar, const Stroke& stroke, int y,
                        const Rect& box, DiminishedFrame& result, Counts& counts);

  std::vector<Stroke> strokes_;  ///< of the bars; there may be more
};

}  // namespace diminish
