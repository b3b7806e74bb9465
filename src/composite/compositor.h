#pragma once

#include <span>

#include "composite/color_smoothing.h"
#include "composite/shadow_gain.h"
#include "composite/shadow_lifting.h"
#include "composite/soft_rim.h"
#include "diminish/color_corrector.h"
#include "diminish/diminished_frame.h"
#include "diminish/inpainter.h"
#include "diminish/options.h"
#include "diminish/rim_line.h"
#include "diminish/view_mode.h"

namespace diminish {

/// Puts the reconstruction where the objects are (Meerits & Saito 2015, section 3.4). One call per
/// stage, in this order, on a result that has its reconstruction and surfaces.
class Compositor {
 public:
  /// The input of every stage.
  struct Inputs {
    ImageView<Bgr> camera;  ///< the colour camera's image
    const Mask& occlusion;  ///< of the objects to remove
    Rect objects;           ///< its bounding box
    const Options& options;
    int smoothing_share;                  ///< of ColorSmoothing's change
    std::span<const RimLine> lines = {};  ///< for an inpainting method that uses them
  };

  /// Stage::compositing. Fills picture, mask, provenance and the pixel counts. The picture becomes
  /// the camera's, and the mask's pixels are sorted into seen ones and ones to inpaint.
  static void sort(const Inputs& inputs, DiminishedFrame& result);

  /// Stage::colors. Gives seen pixels their corrected colour.
  static void correct_colors(const Inputs& inputs, ColorMapsBySource maps,
                             ColorCorrector& corrector, DiminishedFrame& result);

  /// Stage::colors. Removes the objects' shadows, outside the mask, too, and shows what is
  /// remembered.
  void lift_shadows(const Inputs& inputs, std::span<const CastShadow> shadows,
                    const SceneSamples& samples, DiminishedFrame& result);

  /// Sorts what is behind a thing's side (surface_label::standing) into the pixels to inpaint.
  static void hide_behind_sides(const Inputs& inputs, DiminishedFrame& result);

  /// Stage::inpainting. Fills the other pixels of the mask, from unsmoothed pixels, which is 0.1 dB
  /// better than from smoothed ones. False if they cannot be filled. Changes the picture only.
  bool inpaint(const Inputs& inputs, Inpainter& inpainter, DiminishedFrame& result);
  /// Marks the pixels that were to be filled as unknown.
  static void mark_unknown(const Rect& objects, DiminishedFrame& result);

  /// Stage::finish. Removes noise, restores the camera's picture outside the mask, bit for bit,
  /// softens the rim, and applies `mode`.
  void finish(const Inputs& inputs, const ViewMode& mode, DiminishedFrame& result);

 private:
  static void show_remembered(const Rect& part, DiminishedFrame& result);

  ShadowGain shadow_gain_;
  ShadowLifting shadow_lifting_;
  ColorSmoothing color_smoothing_;
  SoftRim soft_rim_;
  Mask missing_;  ///< nothing is set outside `missing_part_`
  Rect missing_part_;
};

}  // namespace diminish
