#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/gpu_pass.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/poses.h"
#include "diminish/reconstruction.h"
#include "diminish/registry.h"
#include "diminish/rig.h"

namespace diminish {

/// One image for each RGB-D camera, in its own units; 0: nothing to draw.
using DepthImages = std::vector<Image<std::uint16_t>>;

/// Draws what the RGB-D cameras see, without the objects, from the colour camera's viewpoint.
/// Registered by name, one per implementation ("reference", ...).
class DIMINISH_EXPORT Reconstructor {
 public:
  static constexpr const char* kind = "reconstruction backend";

  /// When `backend: auto` chooses it.
  enum class Suited {
    when_named,     ///< never
    always,         ///< if nothing better is there; it also draws when another backend fails
    with_hardware,  ///< first of all
  };
  /// Creates a backend.
  class Factory {
   public:
    using Make = std::function<std::unique_ptr<Reconstructor>(const Rig& rig)>;
    /// suited: called only when needed, because it may take a while.
    Factory(Make make, std::function<Suited()> suited)
        : make_(std::move(make)), suited_(std::move(suited)) {}
    template <class AnyMake>
    Factory(AnyMake make) : Factory(std::move(make), [] { return Suited::when_named; }) {}

    std::unique_ptr<Reconstructor> operator()(const Rig& rig) const { return make_(rig); }
    Suited suited() const { return suited_(); }

   private:
    Make make_;
    std::function<Suited()> suited_;
  };

  virtual ~Reconstructor() = default;

  /// depths: the depth image to draw for each RGB-D camera. masks: already grown. region: the part
  /// to draw, inside the colour image; other tiles come out empty. RGB-D cameras without images or
  /// without a pose in this frame take no part.
  virtual void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                           const OcclusionMasks& masks, const TiledRegion& region,
                           const Options& options, Reconstruction& reconstruction) = 0;

  /// Whose colours are wanted. Depths and sources are always filled.
  enum class Colors {
    all,
    /// Pixels at most `contact_reach_px` away from the objects to remove, which have a contact line
    /// that is found meanwhile, and every `sparse_step`-th column of every `sparse_step`-th row of
    /// the region, from its first on. The others' may be filled or empty.
    sparse
  };
  static constexpr int sparse_step = 4;
  static int contact_reach_px(const Options& options) {
    return options.contact_line_px > 0 ? options.contact_line_px + 1 : 0;
  }
  /// From the next frame on; by default all.
  virtual void want_colors(Colors /*wanted*/) {}

  /// Whether cameras take part whose images are on other machines (RgbdFrame::remote). If not, the
  /// CPU draws a frame that has any.
  virtual bool merges_remote() const { return false; }

  /// The name of the MaskDrawer that goes with it.
  virtual std::string mask_drawer() const { return "cpu"; }

  /// The GPU driver's name; empty if the CPU draws.
  virtual const std::string& device() const {
    static const std::string cpu;
    return cpu;
  }
  /// The GPU's passes in the last frame.
  virtual const std::vector<GpuPass>& gpu_passes() const {
    static const std::vector<GpuPass> none;
    return none;
  }
};

}  // namespace diminish
