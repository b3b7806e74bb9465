#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "blend/camera_blender.h"
#include "blend/layers.h"
#include "core/rows.h"
#include "diminish/error.h"
#include "diminish/reconstructor.h"
#include "reconstruct/clear_outside.h"
#include "render/cell_rasterizer.h"
#include "render/sdct.h"
#include "render/texture_lookup.h"
#include "render/vertex_row.h"

namespace diminish {
namespace {

/// Colours are looked up eight bytes at a time.
constexpr int min_texture_side = 8;

/// Draws one RGB-D camera's mesh in two parts, which two threads may draw at the same time:
/// alternate bands of the depth image's rows, so that both have about the same work wherever the
/// objects are.
class CameraMesh {
 public:
  static constexpr int parts = 2;

  CameraMesh(const RgbdCamera& camera, const Intrinsics& color)
      : visible_(camera, color), rows_(camera, color) {
    for (Part& part : parts_) {
      for (VertexRow& row : part.vertices) row.resize(rows_.width());
    }
  }

  /// Call before drawing the parts.
  void begin(const Image<std::uint16_t>& depth, const RigidTransform& color_from_depth,
             const Rect& region) {
    visible_.find(depth, color_from_depth, region);
  }

  const VisibleBlocks& visible() const { return visible_; }

  /// Two rows of vertices at a time. Whole blocks of cells that cannot touch the region are
  /// skipped.
  void draw(const VertexRows::Frame& frame, const TiledRegion& region,
            const sdct::Threshold& threshold, int which) {
    parts_[which].surface.clear(frame.region);
    for (int first = which * band; first < rows_.height() - 1; first += parts * band) {
      draw_band(frame, region, threshold, {first, std::min(first + band, rows_.height() - 1)},
                parts_[which]);
    }
  }

  /// Merges a row's parts after they are drawn.
  void merge(const TiledRegion& region, int y) {
    SurfaceBuffer& upper = parts_[0].surface;
    SurfaceBuffer& lower = parts_[1].surface;
    if (upper.touches(y) && lower.touches(y)) keep_nearest(lower, y, upper);
    SurfaceBuffer& merged = surface(y);
    region.for_each_gap(y, [&](int first, int last) {
      float* row = merged.inverse_z.data() + merged.row(y) - region.x;
      std::fill(row + first, row + last, 0.F);
    });
  }

  /// The merged surface of a row.
  SurfaceBuffer& surface(int y) { return parts_[parts_[0].surface.touches(y) ? 0 : 1].surface; }
  const SurfaceBuffer& surface(int y) const {
    return parts_[parts_[0].surface.touches(y) ? 0 : 1].surface;
  }

 private:
  static constexpr int band = 32;  ///< rows

  struct Part {
    VertexRow vertices[2];
    SurfaceBuffer surface;
  };

  /// Draws the cells below each of the rows.
  void draw_band(const VertexRows::Frame& frame, const TiledRegion& region,
                 const sdct::Threshold& threshold, Rows rows, Part& part) const {
    auto& [vertices, surface] = part;
    rows_.project(frame, rows.first, vertices[rows.first % 2]);
    for (int y = rows.first; y < rows.last; ++y) {
      VertexRow& upper = vertices[y % 2];
      VertexRow& lower = vertices[(y + 1) % 2];
      rows_.project(frame, y + 1, lower);
      const int blocks = static_cast<int>(upper.beyond.size()) - 1;
      for (int block = 0; block < blocks; ++block) {
        const auto b = static_cast<std::size_t>(block);
        if ((upper.beyond[b] & upper.beyond[b + 1] & lower.beyond[b] & lower.beyond[b + 1]) != 0) {
          continue;
        }
        if (!region.is_whole() &&
            !region.touches(join(join(upper.bounds[b], upper.bounds[b + 1]),
                                 join(lower.bounds[b], lower.bounds[b + 1])))) {
          continue;
        }
        for (int k = block; k < std::min(block + 2, blocks); ++k) {
          const auto i = static_cast<std::size_t>(k);
          if (!upper.has_colors[i]) rows_.find_colors(frame, y, k, upper);
          if (!lower.has_colors[i]) rows_.find_colors(frame, y + 1, k, lower);
        }
        draw_cells(upper, lower, block, threshold, surface);
      }
    }
  }

  VisibleBlocks visible_;
  VertexRows rows_;
  Part parts_[parts];
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

  void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                   const OcclusionMasks& masks, const TiledRegion& region, const Options& options,
                   Reconstruction& reconstruction) override {
    clear_outside(color_, region, reconstruction);
    drawn_.clear();
    for (std::size_t k = 0; k < meshes_.size(); ++k) {
      if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) continue;
      drawn_.push_back({k, 0});
      meshes_[k].begin(depths[k], *poses.color_from_depth[k], region);
    }
    const sdct::Threshold threshold(options.discontinuity_threshold_m,
                                    options.discontinuity_reach_m);
    oneapi::tbb::parallel_for(
        std::size_t{0}, CameraMesh::parts * drawn_.size(), [&](std::size_t i) {
          const std::size_t k = drawn_[i / CameraMesh::parts].camera;
          meshes_[k].draw(
              {depths[k], masks.rgbd_depth[k], masks.rgbd_color[k],
               FloatTransform(*poses.color_from_depth[k]), region, meshes_[k].visible()},
              region, threshold, static_cast<int>(i % CameraMesh::parts));
        });
    for_rows(region.height, [&](Rows rows) {
      for (const Drawn& drawn : drawn_) {
        CameraMesh& mesh = meshes_[drawn.camera];
        for (int y = rows.first; y < rows.last; ++y) mesh.merge(region, region.y + y);
      }
    });
    if (drawn_.size() > 1) sort_by_coverage(region);
    const auto agreement_m = static_cast<float>(options.depth_agreement_m);
    const bool blended = drawn_.size() > 1 && drawn_.size() <= blending::most_cameras &&
                         options.merge_cameras == "blend";
    resize_second(blended, color_, reconstruction.second);
    if (blended) begin_blending(poses, region, agreement_m);
    for_rows(region.height, [&](Rows rows) {
      Thread& thread = threads_[rows.first == 0 ? 0 : 1];
      for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
        if (blended) {
          blend_row(frame, y, thread, reconstruction);
        } else {
          color_row(frame, y, agreement_m, thread.surfaces, reconstruction);
        }
      }
    });
  }

 private:
  struct Drawn {
    std::size_t camera;
    int pixels;
  };

  /// Scratch memory of one thread for a row.
  struct Thread {
    std::vector<SurfaceRow> surfaces;
    std::vector<float> second_depth_m;
    CameraBlender::Scratch blending;
  };

  /// Orders the cameras: the one that sees most of the region first, like merge_layers. Cameras
  /// that see nothing of it are left out.
  void sort_by_coverage(const Rect& region) {
    for (Drawn& drawn : drawn_) {
      drawn.pixels = sum_over_rows(region.height, [&](Rows rows) {
        int pixels = 0;
        for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
          pixels += count_drawn(meshes_[drawn.camera].surface(y), y);
        }
        return pixels;
      });
    }
    std::stable_sort(drawn_.begin(), drawn_.end(),
                     [](const Drawn& a, const Drawn& b) { return a.pixels > b.pixels; });
    while (drawn_.size() > 1 && drawn_.back().pixels == 0) drawn_.pop_back();
  }

  void begin_blending(const Poses& poses, const Rect& region, float agreement_m) {
    blended_.resize(drawn_.size());
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
      const std::size_t k = drawn_[i].camera;
      CameraBlender::Surface& surface = blended_[i];
      surface.source = static_cast<std::uint8_t>(1 + k);
      surface.place = CameraPlace(*poses.color_from_depth[k]);
      surface.rows.clear();
      for (int y = region.y; y < region.bottom(); ++y) {
        surface.rows.push_back(&meshes_[k].surface(y));
      }
    }
    blender_.begin(blended_, region, color_, agreement_m);
  }

  void blend_row(const FrameSet& frame, int y, Thread& thread,
                 Reconstruction& reconstruction) const {
    const Rect& region = reconstruction.region;
    SecondView& second = reconstruction.second;
    thread.second_depth_m.resize(static_cast<std::size_t>(region.width));
    const TwoSources chosen{reconstruction.source.row(y) + region.x,
                            reconstruction.depth_m.row(y) + region.x,
                            second.source.row(y) + region.x, thread.second_depth_m.data(),
                            second.share.row(y) + region.x};
    Bgra* const colors = reconstruction.color.row(y) + region.x;
    Bgra* const second_colors = second.color.row(y) + region.x;
    std::fill_n(colors, region.width, Bgra{});
    std::fill_n(second_colors, region.width, Bgra{});
    for (const BlendedRow& row : blender_.choose(y, chosen, thread.blending)) {
      const ImageView<Bgr> texture = frame.rgbd[row.source - 1U].color;
      look_up_colors(row, texture, region.width, chosen.source, chosen.depth_m, colors);
      look_up_colors(row, texture, region.width, chosen.second_source, chosen.second_depth_m,
                     second_colors);
    }
  }

  void color_row(const FrameSet& frame, int y, float agreement_m, std::vector<SurfaceRow>& surfaces,
                 Reconstruction& reconstruction) const {
    surfaces.clear();
    for (const Drawn& drawn : drawn_) {
      surfaces.emplace_back(meshes_[drawn.camera].surface(y), y,
                            static_cast<std::uint8_t>(1 + drawn.camera));
    }
    const Rect& region = reconstruction.region;
    std::uint8_t* source = reconstruction.source.row(y) + region.x;
    float* depth_m = reconstruction.depth_m.row(y) + region.x;
    Bgra* colors = reconstruction.color.row(y) + region.x;
    choose_source(surfaces, agreement_m, region.width, source, depth_m);
    std::fill_n(colors, region.width, Bgra{});
    for (const SurfaceRow& row : surfaces) {
      look_up_colors(row, frame.rgbd[row.source - 1U].color, region.width, source, depth_m, colors);
    }
  }

  Intrinsics color_;
  std::vector<CameraMesh> meshes_;
  std::vector<Drawn> drawn_;
  std::vector<CameraBlender::Surface> blended_;
  CameraBlender blender_;
  Thread threads_[2];
};

std::unique_ptr<Reconstructor> make(const Rig& rig) {
  return std::make_unique<VectorizedReconstructor>(rig);
}

const bool registered =
    Registry<Reconstructor>::add("cpu", {make, [] { return Reconstructor::Suited::always; }});

}  // namespace
}  // namespace diminish
