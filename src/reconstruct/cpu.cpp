#include <algorithm>
#include <vector>

#include "blend/camera_blender.h"
#include "blend/layers.h"
#include "core/rows.h"
#include "core/tasks.h"
#include "diminish/error.h"
#include "diminish/reconstructor.h"
#include "diminish/remote_images.h"
#include "reconstruct/clear_outside.h"
#include "reconstruct/near_objects.h"
#include "render/camera_mesh.h"
#include "render/sdct.h"
#include "render/texture_lookup.h"

namespace diminish {
namespace {

/// Colours are looked up eight bytes at a time.
constexpr int min_texture_side = 8;

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

  void want_colors(Colors wanted) override { wanted_colors_ = wanted; }
  bool merges_remote() const override { return true; }

  void reconstruct(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                   const OcclusionMasks& masks, const TiledRegion& region, const Options& options,
                   Reconstruction& reconstruction) override {
    if (wanted_colors_ == Colors::sparse) {
      near_objects_.find(masks.color, region, contact_reach_px(options));
    }
    clear_outside(color_, region, reconstruction);
    drawn_.clear();
    layers_.assign(meshes_.size(), nullptr);
    for (std::size_t k = 0; k < meshes_.size(); ++k) {
      if (!frame.rgbd[k].takes_part() || !poses.color_from_depth[k]) continue;
      drawn_.push_back({k, 0, frame.rgbd[k].is_remote()});
      if (drawn_.back().is_remote) {
        frame.rgbd[k].remote->draw({*poses.color_from_depth[k], masks.rgbd_color[k],
                                    masks.rgbd_depth[k], region, options});
      }
    }
    const auto input_of = [&, threshold =
                                  sdct::Threshold(options.discontinuity_threshold_m,
                                                  options.discontinuity_reach_m)](std::size_t k) {
      return CameraMesh::Input{
          depths[k], masks.rgbd_depth[k], masks.rgbd_color[k], *poses.color_from_depth[k], region,
          threshold};
    };
    for_tasks(drawn_.size(), [&](std::size_t i) {
      const std::size_t k = drawn_[i].camera;
      if (drawn_[i].is_remote) return meshes_[k].begin(region);
      meshes_[k].begin(input_of(k));
    });
    const auto draw = [&](const Drawn& drawn, Rows rows) {
      CameraMesh& mesh = meshes_[drawn.camera];
      if (drawn.is_remote) return mesh.take(*layers_[drawn.camera], region, rows);
      mesh.draw(input_of(drawn.camera), rows);
    };
    if (drawn_.size() < 2) wait_for_layers(frame);
    const auto agreement_m = static_cast<float>(options.depth_agreement_m);
    if (drawn_.size() < 2) {
      resize_second(false, color_, reconstruction.second);
      for_rows(
          region.height,
          [&](Rows rows) {
            for (const Drawn& drawn : drawn_) draw(drawn, rows);
            // Once the surface is there, smaller bands do.
            for_tasks(parts_of_band, [&](std::size_t i) {
              const auto part = static_cast<int>(i);
              const int height = rows.last - rows.first;
              color_rows(frame,
                         {rows.first + part * height / parts_of_band,
                          rows.first + (part + 1) * height / parts_of_band,
                          parts_of_band * rows.band + part},
                         agreement_m, reconstruction);
            });
          },
          CameraMesh::band_px);
      return;
    }
    const auto draw_all = [&](bool remote) {
      for_rows(
          region.height,
          [&](Rows rows) {
            for_tasks(drawn_.size(), [&](std::size_t i) {
              if (drawn_[i].is_remote == remote) draw(drawn_[i], rows);
            });
          },
          CameraMesh::band_px);
    };
    draw_all(false);
    // The other machines have drawn meanwhile.
    if (wait_for_layers(frame)) draw_all(true);
    sort_by_coverage(region);
    const bool blended = drawn_.size() > 1 && drawn_.size() <= blending::most_cameras &&
                         options.merge_cameras == "blend";
    resize_second(blended, color_, reconstruction.second);
    if (blended) begin_blending(poses, region, agreement_m);
    for_rows(region.height, [&](Rows rows) {
      if (!blended) return color_rows(frame, rows, agreement_m, reconstruction);
      for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
        blend_row(frame, y, scratch_[rows.band], reconstruction);
      }
    });
  }

 private:
  struct Drawn {
    std::size_t camera;
    int pixels;
    bool is_remote;
  };

  static constexpr int parts_of_band = 2;

  /// Memory for one row.
  struct Scratch {
    std::vector<float> second_depth_m;
    CameraBlender::Scratch blending;
  };

  /// Those that do not come take no part. Returns whether there are any.
  bool wait_for_layers(const FrameSet& frame) {
    bool is_any = false;
    for (const Drawn& drawn : drawn_) {
      if (!drawn.is_remote) continue;
      layers_[drawn.camera] = frame.rgbd[drawn.camera].remote->layer();
      is_any = is_any || layers_[drawn.camera];
    }
    std::erase_if(drawn_,
                  [&](const Drawn& drawn) { return drawn.is_remote && !layers_[drawn.camera]; });
    return is_any;
  }

  /// Orders the cameras: the one that sees most of the region first, like merge_layers. Cameras
  /// that see nothing of it are left out.
  void sort_by_coverage(const TiledRegion& region) {
    for (Drawn& drawn : drawn_) {
      drawn.pixels = sum_over_rows(region.height, [&](Rows rows) {
        int pixels = 0;
        for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
          region.for_each_run(y, [&](int first, int last) {
            pixels += count_drawn(meshes_[drawn.camera].surface(y), y, first, last);
          });
        }
        return pixels;
      });
    }
    std::sort(drawn_.begin(), drawn_.end(), [](const Drawn& a, const Drawn& b) {
      return a.pixels != b.pixels ? a.pixels > b.pixels : a.camera < b.camera;
    });
    while (drawn_.size() > 1 && drawn_.back().pixels == 0) drawn_.pop_back();
  }

  void begin_blending(const Poses& poses, const TiledRegion& region, float agreement_m) {
    blended_.resize(drawn_.size());
    for (std::size_t i = 0; i < drawn_.size(); ++i) {
      const std::size_t k = drawn_[i].camera;
      CameraBlender::Surface& surface = blended_[i];
      surface.source = static_cast<std::uint8_t>(1 + k);
      surface.place = CameraPlace(*poses.color_from_depth[k]);
      surface.resolution = layers_[k] ? &layers_[k]->resolution : nullptr;
      surface.rows.clear();
      for (int y = region.y; y < region.bottom(); ++y) {
        surface.rows.push_back(&meshes_[k].surface(y));
      }
    }
    blender_.begin(blended_, region, color_, agreement_m);
  }

  void blend_row(const FrameSet& frame, int y, Scratch& scratch,
                 Reconstruction& reconstruction) const {
    const Rect& region = reconstruction.region;
    SecondView& second = reconstruction.second;
    scratch.second_depth_m.resize(static_cast<std::size_t>(region.width));
    const TwoSources chosen{reconstruction.source.row(y) + region.x,
                            reconstruction.depth_m.row(y) + region.x,
                            second.source.row(y) + region.x, scratch.second_depth_m.data(),
                            second.share.row(y) + region.x};
    Bgra* const colors = reconstruction.color.row(y) + region.x;
    Bgra* const second_colors = second.color.row(y) + region.x;
    std::fill_n(colors, region.width, Bgra{});
    std::fill_n(second_colors, region.width, Bgra{});
    for (const BlendedRow& row : blender_.choose(y, chosen, scratch.blending)) {
      look_up_wanted(row, frame, y, region, chosen.source, chosen.depth_m, colors);
      look_up_wanted(row, frame, y, region, chosen.second_source, chosen.second_depth_m,
                     second_colors);
    }
  }

  void color_rows(const FrameSet& frame, Rows rows, float agreement_m,
                  Reconstruction& reconstruction) {
    const int top = reconstruction.region.y;
    for (int y = top + rows.first; y < top + rows.last; ++y) {
      color_row(frame, y, agreement_m, surfaces_[rows.band], reconstruction);
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
      look_up_wanted(row, frame, y, region, source, depth_m, colors);
    }
  }

  /// Looks up a row's colours, as far as they are wanted.
  void look_up_wanted(const SurfaceRow& row, const FrameSet& frame, int y, const Rect& region,
                      const std::uint8_t* source, const float* depth_m, Bgra* colors) const {
    if (const RemoteLayer* const layer = layers_[row.source - 1U]) {
      const Bgr* const from = layer->color.row(y - region.y);
      for (int x = 0; x < region.width; ++x) {
        if (source[x] == row.source) colors[x] = {from[x].b, from[x].g, from[x].r, 255};
      }
      return;
    }
    const ImageView<Bgr> texture = frame.rgbd[row.source - 1U].color;
    if (wanted_colors_ == Colors::all || (y - region.y) % sparse_step == 0) {
      look_up_colors(row, texture, region.width, source, depth_m, colors);
      return;
    }
    const NearObjects::Columns& near = near_objects_.row(y);
    const int first = near.first - region.x;
    const int count = near.last - near.first;
    if (count <= 0) return;
    look_up_colors(row.from(first), texture, count, source + first, depth_m + first,
                   colors + first);
  }

  Intrinsics color_;
  Colors wanted_colors_ = Colors::all;
  NearObjects near_objects_;  ///< of this frame
  std::vector<CameraMesh> meshes_;
  std::vector<Drawn> drawn_;
  std::vector<const RemoteLayer*> layers_;  ///< of each camera; null: drawn here
  std::vector<CameraBlender::Surface> blended_;
  CameraBlender blender_;
  Scratch scratch_[most_bands];                                   ///< of each band of the region
  std::vector<SurfaceRow> surfaces_[most_bands * parts_of_band];  ///< of a row of each part
};

std::unique_ptr<Reconstructor> make(const Rig& rig) {
  return std::make_unique<VectorizedReconstructor>(rig);
}

const bool cpu_registered =
    Registry<Reconstructor>::add("cpu", {make, [] { return Reconstructor::Suited::always; }});

}  // namespace
}  // namespace diminish
