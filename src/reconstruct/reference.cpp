#include <vector>

#include "blend/layers.h"
#include "diminish/reconstructor.h"
#include "reconstruct/clear_outside.h"
#include "render/depth_mesh.h"
#include "render/rasterizer.h"

namespace diminish {
namespace {

/// The plain version: every depth pixel and every triangle, one after the other.
class ReferenceReconstructor : public Reconstructor {
 public:
  explicit ReferenceReconstructor(const Rig& rig) : color_(rig.color) {
    for (const RgbdCamera& camera : rig.rgbd) meshes_.emplace_back(camera, rig.color);
    layers_.resize(rig.rgbd.size());
    drawn_.resize(rig.rgbd.size());
  }

  void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                   const OcclusionMasks& masks, const TiledRegion& region, const Options& options,
                   Reconstruction& reconstruction) override {
    clear(region, reconstruction);
    const sdct::Threshold threshold(options.discontinuity_threshold_m,
                                    options.discontinuity_reach_m);
    for (std::size_t k = 0; k < meshes_.size(); ++k) {
      drawn_[k] = nullptr;
      if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) continue;
      meshes_[k].compute({depths[k], masks.rgbd_depth[k], masks.rgbd_color[k],
                          FloatTransform(*poses.color_from_depth[k])},
                         vertices_);
      layers_[k].clear(color_.width, color_.height, region);
      draw_mesh(vertices_, frame.rgbd[k].color, threshold, region, layers_[k]);
      for (int y = region.y; y < region.bottom(); ++y) {
        region.for_each_gap(y, [&](int first, int last) {
          std::fill(layers_[k].depth_m.row(y) + first, layers_[k].depth_m.row(y) + last, 0.F);
        });
      }
      drawn_[k] = &layers_[k];
    }
    const auto agreement_m = static_cast<float>(options.depth_agreement_m);
    blended_.clear();
    for (std::size_t k = 0; k < meshes_.size() && options.merge_cameras == "blend"; ++k) {
      if (!drawn_[k] || count_drawn(*drawn_[k], region) == 0) continue;
      blended_.push_back(
          {&layers_[k], CameraPlace(*poses.color_from_depth[k]), static_cast<std::uint8_t>(1 + k)});
    }
    const bool blended = blended_.size() > 1 && blended_.size() <= blending::most_cameras;
    resize_second(blended, color_, reconstruction.second);
    if (blended) {
      blend_layers(blended_, color_, agreement_m, reconstruction);
    } else {
      merge_layers(drawn_, agreement_m, reconstruction);
    }
  }

 private:
  void clear(const TiledRegion& region, Reconstruction& reconstruction) const {
    reconstruction.region = region;
    reconstruction.color.resize(color_.width, color_.height, {});
    reconstruction.depth_m.resize(color_.width, color_.height, 0.F);
    reconstruction.source.resize(color_.width, color_.height, 0);
  }

  Intrinsics color_;
  std::vector<DepthMesh> meshes_;
  Image<MeshVertex> vertices_;
  std::vector<Layer> layers_;
  std::vector<const Layer*> drawn_;
  std::vector<BlendedLayer> blended_;
};

const bool reference_registered = Registry<Reconstructor>::add(
    "reference", [](const Rig& rig) { return std::make_unique<ReferenceReconstructor>(rig); });

}  // namespace
}  // namespace diminish
