#pragma once

#include <span>
#include <string>
#include <vector>

#include "composite/texture_output.h"
#include "diminish/color_corrector.h"
#include "diminish/diminished_frame.h"
#include "diminish/inpainter.h"
#include "diminish/reconstructor.h"
#include "scene/background_planes.h"
#include "scene/cast_shadows.h"

namespace diminish {

/// What the methods that the options name say of themselves.
struct FrameMethods {
  ColorCorrector::Declaration color;
  Inpainter::Declaration inpainting;
  std::string mode;        ///< the view mode's name
  bool remembers = false;  ///< something is put between drawing and compositing
};

/// A frame when only its pixels are left to do: its images, and what follows from thin samples of
/// them.
struct FrameInputs {
  const FrameSet& frame;
  const DepthImages& depths;
  const Poses& poses;
  const OcclusionMasks& masks;
  Rect objects;  ///< the objects' mask's bounding box
  /// Holds it, and at least a pixel more on each side that is not the picture's.
  const TiledRegion& region;
  const Options& options;
  const FrameMethods& methods;
  // What a backend that only draws is not told: it may be learnt at the same time.
  const std::vector<BackgroundPlane>* planes = nullptr;  ///< null: not looked for
  std::span<const CastShadow> shadows = {};
  ColorMapsBySource color_maps = {};
  int smoothing_share = 0;           ///< of ColorSmoothing's change
  bool wants_reconstruction = true;  ///< in the result
  TextureOutput* texture = nullptr;  ///< where the picture goes; null: to the result
};

/// A backend that does stages after the drawing, too, where it need not give away what it has
/// drawn.
class ComposingReconstructor : public Reconstructor {
 public:
  /// Whether it does this stage of a frame with these methods. It is asked in the stages' order,
  /// from the one after the drawing on, until it says no.
  virtual bool takes_over(Stage stage, const FrameMethods& methods) const = 0;

  /// Draws, and does the stages after that up to `last`: fills what they fill. The reconstruction
  /// and the surfaces are filled where they are wanted, or somebody has to go on with them; else
  /// they have a region, and their images are empty. So are picture and provenance where `last` is
  /// the last of all and the picture goes to a texture. Throws Error where the GPU fails.
  virtual void compose(const FrameInputs& inputs, Stage last, DiminishedFrame& result) = 0;
};

}  // namespace diminish
