#include <algorithm>
#include <vector>

#include "diminish/error.h"
#include "diminish/reconstructor.h"
#include "reconstruct/cell_rasterizer.h"
#include "reconstruct/texture_lookup.h"
#include "reconstruct/vertex_row.h"

namespace diminish {
namespace {

/// Colours are looked up eight bytes at a time.
constexpr int min_texture_side = 8;

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
    for (const RgbdCamera& camera : rig.rgbd) {
      if (std::min(camera.color.width, camera.color.height) < min_texture_side) {
        throw Error(camera.name + ": expected a colour image of at least 8x8 pixels");
      }
      meshes_.emplace_back(camera, rig.color);
    }
  }

  void reconstruct(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                   const Rect& region, const Options& options,
                   Reconstruction& reconstruction) override {
    clear_outside(region, reconstruction);
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
      rows_.clear();
      for (const Drawn& drawn : drawn_) {
        rows_.emplace_back(meshes_[drawn.camera].surface(), y,
                           static_cast<std::uint8_t>(1 + drawn.camera));
      }
      std::uint8_t* source = reconstruction.source.row(y) + region.x;
      float* depth_m = reconstruction.depth_m.row(y) + region.x;
      Bgra* colors = reconstruction.color.row(y) + region.x;
      choose_source(rows_, agreement_m, region.width, source, depth_m);
      std::fill_n(colors, region.width, Bgra{});
      for (const SurfaceRow& row : rows_) {
        look_up_colors(row, frame.rgbd[row.source - 1U].color, region.width, source, depth_m,
                       colors);
      }
    }
  }

 private:
  struct Drawn {
    std::size_t camera;
    std::size_t pixels;
  };

  /// Everything outside `region` becomes empty; the region's pixels are written later.
  void clear_outside(const Rect& region, Reconstruction& reconstruction) const {
    const bool same_size = reconstruction.color.width() == color_.width &&
                           reconstruction.color.height() == color_.height;
    if (same_size) {
      clear_outside(region, reconstruction.region, reconstruction.color);
      clear_outside(region, reconstruction.region, reconstruction.depth_m);
      clear_outside(region, reconstruction.region, reconstruction.source);
    } else {
      reconstruction.color.resize(color_.width, color_.height, {});
      reconstruction.depth_m.resize(color_.width, color_.height, 0.F);
      reconstruction.source.resize(color_.width, color_.height, 0);
    }
    reconstruction.region = region;
  }
  template <class Pixel>
  static void clear_outside(const Rect& region, const Rect& drawn, Image<Pixel>& image) {
    const Rect both = intersect(region, drawn);
    if (both.empty()) return image.fill(drawn, {});
    image.fill({drawn.x, drawn.y, drawn.width, both.y - drawn.y}, {});
    image.fill({drawn.x, both.y, both.x - drawn.x, both.height}, {});
    image.fill({both.right(), both.y, drawn.right() - both.right(), both.height}, {});
    image.fill({drawn.x, both.bottom(), drawn.width, drawn.bottom() - both.bottom()}, {});
  }

  /// The camera that sees most of the region first, as merge_layers does.
  void sort_by_coverage() {
    for (Drawn& drawn : drawn_) drawn.pixels = count_drawn(meshes_[drawn.camera].surface());
    std::stable_sort(drawn_.begin(), drawn_.end(),
                     [](const Drawn& a, const Drawn& b) { return a.pixels > b.pixels; });
  }
  static std::size_t count_drawn(const SurfaceBuffer& surface) {
    std::size_t count = 0;
    for (int y = surface.region.y; y < surface.region.bottom(); ++y) {
      const float* inverse_z = surface.inverse_z.data() + surface.row(y);
      int in_row = 0;
      for (int i = 0; i < surface.region.width; ++i) in_row += inverse_z[i] > 0 ? 1 : 0;
      count += static_cast<std::size_t>(in_row);
    }
    return count;
  }

  Intrinsics color_;
  std::vector<CameraMesh> meshes_;
  std::vector<Drawn> drawn_;
  std::vector<SurfaceRow> rows_;
};

const bool registered = Registry<Reconstructor>::add(
    "cpu", [](const Rig& rig) { return std::make_unique<VectorizedReconstructor>(rig); });

}  // namespace
}  // namespace diminish
