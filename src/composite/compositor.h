#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "composite/color_smoothing.h"
#include "composite/shadow_lifting.h"
#include "composite/soft_rim.h"
#include "diminish/color_corrector.h"
#include "diminish/diminished_frame.h"
#include "diminish/inpainter.h"
#include "diminish/options.h"
#include "diminish/view_mode.h"

namespace diminish {

/// Puts the reconstruction where the objects are (Meerits & Saito 2015, section 3.4).
class Compositor {
 public:
  /// What can be done before the scene is drawn; to be called before `composite` with the same
  /// frame.
  void prepare(const Image<Bgr>& camera, const Mask& occlusion, const Options& options,
               const std::vector<SceneSample>& samples);

  /// result.reconstruction has been drawn. Fills picture, mask, provenance, the pixel counts and
  /// the times of the stages. Outside the mask the picture is `camera`, bit for bit; inside, pixels
  /// that were reconstructed are colour-corrected, and the others are inpainted.
  /// objects: the mask's bounding box.
  void composite(const Image<Bgr>& camera, const Mask& occlusion, const Rect& objects,
                 const Options& options, DiminishedFrame& result);

  /// The rest, where all that `composite` does before inpainting is done: a GPU has filled picture,
  /// mask, provenance and pixel counts.
  void complete(const Image<Bgr>& camera, const Mask& occlusion, const Rect& objects,
                const Options& options, DiminishedFrame& result);

  /// Whether the reconstruction's `surface` is used.
  bool uses_surfaces(const Options& options);

 private:
  void show(const Image<Bgr>& camera, const Mask& occlusion, const Options& options,
            DiminishedFrame& result);
  void correct_colors(const Image<Bgr>& camera, const Mask& occlusion, const std::string& name,
                      DiminishedFrame& result);
  bool inpaint(const Holes& holes, const Options& options, DiminishedFrame& result);

  ColorCorrector& corrector(const std::string& name);
  Inpainter& inpainter(const std::string& name);
  const ViewMode& view_mode(const std::string& name);

  std::map<std::string, std::unique_ptr<ColorCorrector>> correctors_;
  std::map<std::string, std::unique_ptr<Inpainter>> inpainters_;
  std::map<std::string, std::unique_ptr<ViewMode>> view_modes_;
  ShadowLifting shadow_lifting_;
  ColorSmoothing color_smoothing_;
  SoftRim soft_rim_;
  Mask missing_;
  Rect objects_;  ///< the mask's bounding box
};

}  // namespace diminish
