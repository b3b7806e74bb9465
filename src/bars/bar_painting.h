#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "bars/bar.h"
#include "bars/bar_views.h"
#include "diminish/diminished_frame.h"
#include "diminish/image.h"

namespace diminish {

/// Draws bars into the mask, over what is invented and over what an RGB-D camera sees behind them.
class BarPainting {
 public:
  struct Input {
    std::span<const Bar> bars;  ///< the surest first
    const BarViews& views;
    const std::vector<BackgroundPlane>& planes;
    ImageView<Bgr> camera;  ///< the user's picture
    const Mask& occlusion;  ///< of the colour camera
    const Rect& objects;    ///< its box
  };
  /// Changes picture, provenance and counts of `result`. A bar has the colours that the user's
  /// camera sees beside the mask, of both ends where it goes on beyond. It ends where it leaves the
  /// mask, meets another plane, or where an RGB-D camera sees what would be behind it. What stands
  /// in front hides it; what the user's camera has seen itself stays. Cost: 30 ns a pixel.
  void paint(const Input& input, DiminishedFrame& result);

 private:
  /// A fourth channel, 0, makes it a vector.
  using Profile = std::vector<Eigen::Array4f>;

  static bool collect(const Input& input, const Bar& bar, float begin, float sign,
                      Profile& profile);
  /// How far it goes on, pixels; and whether it ends only because the mask does.
  struct End {
    float along;
    bool leaves_mask;
  };
  static End find_end(const Input& input, const Bar& bar);
  /// A bar as it is painted.
  struct Stroke {
    const Bar& bar;
    float length;  ///< in the mask
    float end;     ///< the last place along it
    bool has_far;  ///< colours of its other end
  };
  /// How many pixels are estimated now, and how many of them were invented.
  struct Counts {
    std::size_t estimated = 0, inpainted = 0;

    friend Counts operator+(const Counts& a, const Counts& b) {
      return {a.estimated + b.estimated, a.inpainted + b.inpainted};
    }
  };
  /// box: what of the objects' box may show the bar.
  Counts paint_row(const Input& input, const Stroke& stroke, int y, const Rect& box,
                   DiminishedFrame& result) const;
  void paint(const Input& input, const Bar& bar, DiminishedFrame& result);

  Profile near_, far_;
};

}  // namespace diminish
