#pragma once

#include "composite/color_smoothing.h"
#include "composite/shadow_lifting.h"
#include "composite/soft_rim.h"
#include "diminish/color_corrector.h"
#include "diminish/diminished_frame.h"
#include "diminish/inpainter.h"
#include "diminish/options.h"
#include "diminish/view_mode.h"

namespace diminish {

/// Puts the reconstruction where the objects are (Meerits & Saito 2015, section 3.4). One call a
/// stage, in this order, on a result whose reconstruction and surfaces are there.
class Compositor {
 public:
  /// What every stage looks at.
  struct Inputs {
    const Image<Bgr>& camera;  ///< the colour camera's image
    const Mask& occlusion;     ///< of the objects to remove
    Rect objects;              ///< its bounding box
    const Options& options;
  };

  /// Stage::compositing. Fills picture, mask, provenance and the pixel counts: the picture is the
  /// camera's, and the mask's pixels are those that were seen and those to be inpainted.
  static void sort(const Inputs& inputs, DiminishedFrame& result);

  /// Stage::colors. Pixels that were seen get their corrected colour, without the objects' shadows.
  void correct_colors(const Inputs& inputs, ColorMapsBySource maps, ColorCorrector& corrector,
                      DiminishedFrame& result) const;

  /// Stage::inpainting. Fills the other pixels of the mask, and marks those as unknown that cannot
  /// be filled. They are filled from pixels as they were seen: that is 0.1 dB better than from
  /// smoothed ones.
  void inpaint(const Inputs& inputs, Inpainter& inpainter, DiminishedFrame& result);

  /// Stage::finish. Takes out noise, gives the camera back what is outside the mask, bit for bit,
  /// softens the rim, and shows it all as `mode` does.
  void finish(const Inputs& inputs, const ViewMode& mode, DiminishedFrame& result);

 private:
  ShadowLifting shadow_lifting_;
  ColorSmoothing color_smoothing_;
  SoftRim soft_rim_;
  Mask missing_;  ///< nothing is set outside `missing_part_`
  Rect missing_part_;
};

}  // namespace diminish
