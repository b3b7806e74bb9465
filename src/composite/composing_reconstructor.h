#pragma once

#include <span>
#include <vector>

#include "composite/texture_output.h"
#include "diminish/diminished_frame.h"
#include "diminish/reconstructor.h"
#include "scene/background_planes.h"
#include "scene/cast_shadows.h"
#include "scene/color_map.h"

namespace diminish {

/// How far a backend takes a frame; the rest is the processor's.
enum class Reach {
  reconstruction,  ///< no further
  seen,            ///< to the colours of all pixels that a camera sees; they wait for inpainting
  picture,         ///< to the end
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
  const std::vector<BackgroundPlane>* planes;  ///< null: not looked for
  std::span<const CastShadows::Shadow> shadows;
  const std::vector<ColorMap>& color_maps;  ///< by Reconstruction::source
  bool wants_reconstruction;                ///< in the result
  TextureOutput* texture = nullptr;         ///< where the picture goes; null: to the result
};

/// A backend that does not give the reconstruction away where it can go on with it.
class ComposingReconstructor : public Reconstructor {
 public:
  /// How far `compose` goes.
  virtual Reach reach(const Options& options) const = 0;

  /// Does what Reconstructor::reconstruct and the Compositor do, as far as `reach`: fills picture,
  /// mask, provenance and pixel counts. The reconstruction (with surface and light) is filled where
  /// it is wanted or someone has to go on with it; else it has a region, and its images are empty.
  /// So are picture and provenance where `reach` is the picture and that goes to a texture.
  /// Throws Error where the GPU fails.
  virtual void compose(const FrameInputs& inputs, DiminishedFrame& result) = 0;
};

}  // namespace diminish
