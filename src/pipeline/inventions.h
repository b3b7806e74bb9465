#pragma once

#include <span>
#include <vector>

#include "bars/bar_painting.h"
#include "bars/bar_search.h"
#include "bars/bar_views.h"
#include "bars/known_bars.h"
#include "composite/compositor.h"
#include "composite/plane_texture.h"
#include "composite/steady_inventions.h"
#include "diminish/diminished_frame.h"
#include "diminish/frame_set.h"
#include "diminish/inpainter.h"
#include "diminish/occlusion_masks.h"
#include "diminish/rig.h"
#include "diminish/scene_samples.h"
#include "inpaint/rim_lines.h"
#include "scene/background_planes.h"
#include "scene/standing_things.h"

namespace diminish {

/// Invents what no camera sees (docs/filling.md): what runs into the mask is found, then sides of
/// things and bars, then the rest is filled.
class Inventions {
 public:
  explicit Inventions(const Rig& rig);

  struct Wanted {
    bool lines = false;   ///< of the picture, to be continued
    bool sides = false;   ///< of things (StandingThings)
    bool bars = false;    ///< that depth sensors do not see (BarSearch)
    bool grain = false;   ///< of planes (PlaneTexture)
    bool steady = false;  ///< from frame to frame (SteadyInventions)
  };
  void choose(const Wanted& wanted) { wanted_ = wanted; }

  struct Inputs {
    const FrameSet& frame;
    const Poses& poses;
    const OcclusionMasks& masks;
    const Rect& objects;                         ///< the box of the colour camera's mask
    const std::vector<BackgroundPlane>* planes;  ///< null: none are known
    const SceneSamples& samples;
    const BarViews& views;
  };
  /// The lines that run into the mask. Needs the picture and its mask only.
  void find_lines(const FrameSet& frame, const Mask& occlusion, const Rect& objects);
  std::span<const RimLine> lines() const { return rim_lines_.lines(); }

  /// Whether sides or bars are looked for: there must be an object and planes.
  bool looks_for_structure(const Inputs& inputs) const;
  /// Finds sides and bars behind the objects, for `fill`. Takes the memory of the result's
  /// `surfaces.standing_depth_m`, and reads its reconstruction and labels: others may work on the
  /// picture meanwhile.
  void find_structure(const Inputs& inputs, DiminishedFrame& result);

  /// Fills what is missing in the picture.
  void fill(const Inputs& inputs, const Compositor::Inputs& composed, Compositor& compositor,
            Inpainter& inpainter, DiminishedFrame& result);

  /// What the frames of one sequence share.
  SteadyInventions& steady() { return steady_; }
  KnownBars& known_bars() { return known_bars_; }

 private:
  bool finds_sides(const Inputs& inputs) const { return wanted_.sides && inputs.planes != nullptr; }
  bool finds_bars(const Inputs& inputs) const {
    return wanted_.bars && inputs.planes != nullptr && !inputs.objects.empty();
  }

  Wanted wanted_;
  RimLines rim_lines_;
  StandingThings standing_things_;
  Surfaces with_sides_;  ///< labels and depth, once sides were found
  KnownBars known_bars_;
  std::vector<Bar> recalled_bars_;
  BarSearch bar_search_;
  BarPainting bar_painting_;
  PlaneTexture plane_texture_;
  SteadyInventions steady_;
};

}  // namespace diminish
