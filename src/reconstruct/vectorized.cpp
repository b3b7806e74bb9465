#include <algorithm>
#include <vector>

#include "diminish/reconstructor.h"
#include "reconstruct/cell_rasterizer.h"
#include "reconstruct/texture_lookup.h"
#include "reconstruct/vertex_row.h"

namespace diminish {
namespace {

/// Draws one RGB-D camera's mesh.
class CameraMesh {
 public:
  CameraMesh(const RgbdCamera& camera, const Intrinsics& color) : rows_(camera, color) {
    for (VertexRow& row : vertices_) row.resize(rows_.width());
  }

  /// Two rows of vertices at a time; cells that cannot touch the region are left out by the block.
  void draw(const VertexRows::Frame& frame, float threshold_m) {
    surface_.clear(frame.region);
    rows_.project(frame, 0, vertices_[0]);
    for (int y = 0; y + 1 < rows_.height(); ++y) {
      VertexRow& upper = vertices_[y % 2];
      VertexRow& lower = vertices_[(y + 1) % 2];
      rows_.project(frame, y + 1, lower);
      const int blocks = static_cast<int>(upper.beyond.size()) - 1;
      for (int block = 0; block < blocks; ++block) {
        const auto b = static_cast<std::size_t>(block);
        if ((upper.beyond[b] & upper.beyond[b + 1] & lower.beyond[b] & lower.beyond[b + 1]) != 0) {
          continue;
        }
        for (int k = block; k < std::min(block + 2, blocks); ++k) {
          const auto i = static_cast<std::size_t>(k);
          if (!upper.has_colors[i]) rows_.find_colors(frame, y, k, upper);
          if (!lower.has_colors[i]) rows_.find_colors(frame, y + 1, k, lower);
        }
        draw_cells(upper, lower, block, threshold_m, surface_);
      }
    }
  }

  SurfaceBuffer& surface() { return surface_; }

 private:
  VertexRows rows_;
  VertexRow vertices_[2];
  SurfaceBuffer surface_;
};

/// The default: the same rules as ReferenceReconstructor, on vector instructions.
class VectorizedReconstructor : public Reconstructor {
 public:
  explicit VectorizedReconstructor(const Rig& rig) : color_(rig.color) {
    for (const RgbdCamera& camera : rig.rgbd) meshes_.emplace_back(camera, rig.color);
  }

  void reconstruct(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                   const Rect& region, const Options& options,
                   Reconstruction& reconstruction) override {
    clear(region, reconstruction);
    drawn_.clear();
    for (std::size_t k = 0; k < meshes_.size(); ++k) {
      if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) continue;
      meshes_[k].draw({frame.rgbd[k], masks.rgbd_depth[k], masks.rgbd_color[k],
                       FloatTransform(*poses.color_from_depth[k]), region},
                      static_cast<float>(options.discontinuity_threshold_m));
      drawn_.push_back({k, 0});
    }
    if (drawn_.size() > 1) sort_by_coverage();
    const auto agreement_m = static_cast<float>(options.depth_agreement_m);
    for (int y = region.y; y < region.bottom(); ++y) {
      choose(y, agreement_m, reconstruction);
      for (const Drawn& drawn : drawn_) color_row(frame, drawn.camera, y, reconstruction);
    }
  }

 private:
  struct Drawn {
    std::size_t camera;
    std::size_t pixels;
  };

  /// Everything outside `region` becomes empty; the region's pixels are written later.
  void clear(const Rect& region, Reconstruction& reconstruction) const {
    const bool same_size = reconstruction.color.width() == color_.width &&
                           reconstruction.color.height() == color_.height;
    if (same_size) {
      reconstruction.color.fill(reconstruction.region, {});
      reconstruction.depth_m.fill(reconstruction.region, 0.F);
      reconstruction.source.fill(reconstruction.region, 0);
    } else {
      reconstruction.color.resize(color_.width, color_.height, {});
      reconstruction.depth_m.resize(color_.width, color_.height, 0.F);
      reconstruction.source.resize(color_.width, color_.height, 0);
    }
    reconstruction.region = region;
  }

  /// The camera that sees most of the region first, as merge_layers does.
  void sort_by_coverage() {
    for (Drawn& drawn : drawn_) {
      const std::vector<float>& inverse_z = meshes_[drawn.camera].surface().inverse_z;
      drawn.pixels = static_cast<std::size_t>(
          std::count_if(inverse_z.begin(), inverse_z.end(), [](float value) { return value > 0; }));
    }
    std::stable_sort(drawn_.begin(), drawn_.end(),
                     [](const Drawn& a, const Drawn& b) { return a.pixels > b.pixels; });
  }

  /// Decides which camera each pixel of a row is taken from (the rule of merge_layers).
  void choose(int y, float agreement_m, Reconstruction& reconstruction) {
    const Rect& region = reconstruction.region;
    std::uint8_t* source = reconstruction.source.row(y) + region.x;
    if (drawn_.size() == 1) {
      const float* inverse_z = inverse_z_row(drawn_[0].camera, y);
      const auto name = static_cast<std::uint8_t>(1 + drawn_[0].camera);
      for (int i = 0; i < region.width; ++i) source[i] = inverse_z[i] > 0 ? name : 0;
      return;
    }
    nearest_.assign(static_cast<std::size_t>(region.width), 0.F);
    std::fill_n(source, region.width, std::uint8_t{0});
    for (const Drawn& drawn : drawn_) {
      const float* inverse_z = inverse_z_row(drawn.camera, y);
      const auto name = static_cast<std::uint8_t>(1 + drawn.camera);
      for (int i = 0; i < region.width; ++i) {
        if (!(inverse_z[i] > 0)) continue;
        const float z = 1.F / inverse_z[i];
        float& nearest = nearest_[static_cast<std::size_t>(i)];
        if (nearest == 0 || z < nearest - agreement_m) {
          nearest = z;
          source[i] = name;
        }
      }
    }
  }

  const float* inverse_z_row(std::size_t camera, int y) {
    const SurfaceBuffer& surface = meshes_[camera].surface();
    return surface.inverse_z.data() + surface.row(y);
  }

  void color_row(const FrameSet& frame, std::size_t camera, int y, Reconstruction& reconstruction) {
    const Rect& region = reconstruction.region;
    const SurfaceBuffer& surface = meshes_[camera].surface();
    Bgra* color = reconstruction.color.row(y) + region.x;
    float* depth = reconstruction.depth_m.row(y) + region.x;
    if (drawn_.size() == 1) {
      look_up_row(surface, y, nullptr, frame.rgbd[camera].color, color, depth);
      return;
    }
    const std::uint8_t* source = reconstruction.source.row(y) + region.x;
    const auto width = static_cast<std::size_t>(region.width);
    wanted_.resize(width);
    color_row_.resize(width);
    depth_row_.resize(width);
    const auto name = static_cast<std::uint8_t>(1 + camera);
    for (std::size_t i = 0; i < width; ++i) wanted_[i] = source[i] == name ? 255 : 0;
    look_up_row(surface, y, wanted_.data(), frame.rgbd[camera].color, color_row_.data(),
                depth_row_.data());
    for (std::size_t i = 0; i < width; ++i) {
      if (wanted_[i] == 0) continue;
      color[i] = color_row_[i];
      depth[i] = depth_row_[i];
    }
  }

  Intrinsics color_;
  std::vector<CameraMesh> meshes_;
  std::vector<Drawn> drawn_;
  std::vector<float> nearest_, depth_row_;
  std::vector<std::uint8_t> wanted_;
  std::vector<Bgra> color_row_;
};

const bool registered = Registry<Reconstructor>::add(
    "cpu", [](const Rig& rig) { return std::make_unique<VectorizedReconstructor>(rig); });

}  // namespace
}  // namespace diminish
