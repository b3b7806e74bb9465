#include "diminish/pipeline.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <vector>

#include "composite/compositor.h"
#include "core/stopwatch.h"
#include "depth/depth_cleaner.h"
#include "depth/visible_blocks.h"
#include "detect/occlusion_masks.h"
#include "diminish/marker_detector.h"
#include "pipeline/backend.h"
#include "pipeline/frame_texture.h"
#include "pose/camera_poses.h"
#include "pose/pose_refinement.h"
#include "scene/background_planes.h"
#include "scene/cast_shadows.h"
#include "scene/color_maps.h"
#include "scene/scene_sampler.h"

namespace diminish {
namespace {

/// In the picture: what the refinement of poses may move.
constexpr int refinement_margin_px = 24;

template <class Pixel>
void expect_size(const Image<Pixel>& image, const Intrinsics& intrinsics, const std::string& name) {
  if (image.width() != intrinsics.width || image.height() != intrinsics.height) {
    throw Error(fmt::format("{}: expected an image of {}x{}, got {}x{}", name, intrinsics.width,
                            intrinsics.height, image.width(), image.height()));
  }
}

/// Frame sources deliver images of the rig's sizes; a program that makes its own frames may not.
void expect_sizes(const FrameSet& frame, const Rig& rig) {
  if (!frame.color.empty()) expect_size(frame.color, rig.color, "color");
  if (frame.rgbd.size() != rig.rgbd.size()) {
    throw Error(fmt::format("frame: expected {} RGB-D cameras, got {}", rig.rgbd.size(),
                            frame.rgbd.size()));
  }
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    if (!frame.rgbd[k].available()) continue;
    expect_size(frame.rgbd[k].color, rig.rgbd[k].color, color_sensor_name(rig.rgbd[k]));
    expect_size(frame.rgbd[k].depth, rig.rgbd[k].depth, rig.rgbd[k].name + " depth");
  }
}

}  // namespace

struct Pipeline::Implementation {
  Implementation(const Rig& rig_, const Scene& scene_)
      : rig(rig_),
        scene(scene_),
        color_lens(rig.color),
        camera_poses(rig, scene),
        occluders(rig, scene),
        backend(rig),
        sampler(rig),
        pose_refinement(rig.color),
        background_planes(rig.color),
        cast_shadows(rig.color) {
    for (const RgbdCamera& camera : rig.rgbd) {
      rgbd_color_lenses.emplace_back(camera.color);
      visible_depths.emplace_back(camera, rig.color);
      depth_cleaners.emplace_back(camera);
    }
    depths.resize(rig.rgbd.size());
    if (camera_poses.needs_markers() || occluders.needs_markers()) {
      for (std::size_t i = 0; i <= rig.rgbd.size(); ++i) {
        marker_detectors.emplace_back(scene.marker_dictionary);
      }
    }
  }

  void find_markers(const FrameSet& frame, Markers& markers) {
    markers.color.clear();
    markers.rgbd.resize(rig.rgbd.size());
    for (auto& list : markers.rgbd) list.clear();
    if (marker_detectors.empty()) return;
    // One image a core.
    oneapi::tbb::parallel_for(std::size_t{0}, rig.rgbd.size() + 1, [&](std::size_t i) {
      if (i == 0) {
        marker_detectors[i].detect(frame.color, color_lens, markers.color);
      } else if (frame.rgbd[i - 1].available()) {
        marker_detectors[i].detect(frame.rgbd[i - 1].color, rgbd_color_lenses[i - 1],
                                   markers.rgbd[i - 1]);
      }
    });
  }

  /// Finds the parts of the depth images that may be drawn, before poses are refined.
  void find_visible_depths(const FrameSet& frame, const Poses& poses, const Rect& drawn) {
    oneapi::tbb::parallel_for(std::size_t{0}, rig.rgbd.size(), [&](std::size_t k) {
      if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) {
        return visible_depths[k].clear();
      }
      visible_depths[k].find(frame.rgbd[k].depth, *poses.color_from_depth[k],
                             grow(drawn, refinement_margin_px));
    });
  }

  void clean_depths(const FrameSet& frame) {
    const OcclusionMasks& masks = occluders.masks();
    oneapi::tbb::parallel_for(std::size_t{0}, rig.rgbd.size(), [&](std::size_t k) {
      const RgbdFrame& rgbd = frame.rgbd[k];
      if (!rgbd.available()) return;
      depth_cleaners[k].clean(rgbd.depth, {rgbd.color, masks.rgbd_color[k], masks.rgbd_depth[k]},
                              visible_depths[k].part(), options, depths[k]);
    });
  }

  /// What is behind the objects; how far that went towards the picture.
  Reach reconstruct(const FrameSet& frame, DiminishedFrame& result) {
    const OcclusionMasks& masks = occluders.masks();
    const Rect& objects = occluders.objects();
    Poses& poses = result.report.poses;
    Reconstruction& reconstruction = result.reconstruction;
    const Rect whole = rig.color.bounds();
    region.set(options.whole_view ? whole
                                  : intersect(grow(objects, options.surroundings_px), whole));
    sampler.sample(frame, poses, masks, reconstruction);
    find_visible_depths(frame, poses, options.remove_shadows ? whole : region);
    const bool finds_surfaces = compositor.uses_surfaces(options);
    backend.begin_frame();
    const bool composes = backend.reach(options) != Reach::reconstruction;
    cast_shadows.clear();
    const auto prepare_colors = [&] {
      compositor.prepare(frame.color, masks.color, options, reconstruction.samples);
    };
    oneapi::tbb::parallel_invoke(
        [&] {
          if (options.refine_poses) {
            pose_refinement.refine(frame, masks.color, reconstruction, poses);
          }
          if (finds_surfaces) find_background(objects, reconstruction);
          if (composes) {
            fit_color_maps(frame.color, reconstruction);
          } else {
            prepare_colors();
          }
        },
        [&] { clean_depths(frame); });
    if (options.remove_shadows) {
      region.set(join(region, cast_shadows.bounds()));
    } else if (!options.whole_view) {
      region.keep_near(masks.color, options.surroundings_px);
    }
    if (composes) {
      const Reach reach = backend.compose(
          {frame, depths, poses, masks, objects, region, options,
           finds_surfaces ? &background_planes.planes() : nullptr, cast_shadows.shadows(),
           color_maps.by_source(), wants_reconstruction, texture.output()},
          result);
      if (reach != Reach::reconstruction) return reach;
      prepare_colors();
    }
    backend.reconstruct(frame, depths, poses, masks, region, options, reconstruction,
                        result.report.drawing);
    if (finds_surfaces) {
      background_planes.label(reconstruction);
    } else {
      reconstruction.surface.resize(0, 0);
    }
    if (cast_shadows.any()) {
      cast_shadows.shade(reconstruction);
    } else {
      reconstruction.light.resize(0, 0);
    }
    return Reach::reconstruction;
  }

  void find_background(const Rect& objects, const Reconstruction& reconstruction) {
    background_planes.find(objects, reconstruction.samples);
    if (options.lift_shadows || options.remove_shadows) {
      cast_shadows.find(background_planes.planes(), reconstruction.samples,
                        reconstruction.object_points_m);
    }
  }

  void fit_color_maps(const Image<Bgr>& camera, const Reconstruction& reconstruction) {
    if (const MappedMethod* const method = find_mapped_method(options.color_correct)) {
      color_maps.fit(camera, occluders.masks().color, reconstruction.samples, method->model);
    } else {
      color_maps.clear();
    }
  }

  static void begin(const FrameSet& frame, DiminishedFrame& result) {
    result.name = frame.name;
    result.index = frame.index;
    result.stamp_s = frame.stamp_s;
    FrameReport& report = result.report;
    report.mask_pixels = report.valid_pixels = report.missing_pixels = 0;
    report.milliseconds.fill(0);
    report.drawing.milliseconds = 0;
    report.drawing.device.clear();
    report.drawing.passes.clear();
    report.skipped = frame.color.empty();
    report.faults = frame.faults;
    report.messages.clear();
    for (const RgbdFrame& rgbd : frame.rgbd) {
      if (!rgbd.missing.empty()) report.messages.push_back(rgbd.missing);
    }
  }

  Rig rig;
  Scene scene;
  Options options;
  Lens color_lens;
  std::vector<Lens> rgbd_color_lenses;
  std::vector<MarkerDetector> marker_detectors;  ///< of the colour camera and each RGB-D camera
  CameraPoses camera_poses;
  OccluderStage occluders;
  Backend backend;
  std::vector<DepthCleaner> depth_cleaners;
  std::vector<VisibleBlocks> visible_depths;
  DepthImages depths;
  TiledRegion region;  ///< to be drawn
  SceneSampler sampler;
  PoseRefinement pose_refinement;
  BackgroundPlanes background_planes;
  CastShadows cast_shadows;
  ColorMaps color_maps;
  Compositor compositor;
  bool wants_reconstruction = true;
  FrameTexture texture;
};

Pipeline::Pipeline(const Rig& rig, const Scene& scene, const Options& options)
    : implementation_(std::make_unique<Implementation>(rig, scene)) {
  set_options(options);
}
Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

void Pipeline::set_options(const Options& options) {
  check(options, implementation_->scene);
  implementation_->backend.choose(options.backend);
  implementation_->occluders.draw_by(implementation_->backend.mask_drawer());
  implementation_->options = options;
}
void Pipeline::want_reconstruction(bool wanted) {
  implementation_->wants_reconstruction = wanted;
}
void Pipeline::want_texture(const std::optional<GlSharing>& application) {
  Implementation& self = *implementation_;
  self.texture.put_to(nullptr);
  if (application) self.texture.put_to(make_texture_output(*application, self.rig.color));
}
const GlTexture& Pipeline::texture() const {
  return implementation_->texture.texture();
}
const Options& Pipeline::options() const {
  return implementation_->options;
}

// Meerits & Saito 2015, section 3, in its order.
void Pipeline::process(const FrameSet& frame, DiminishedFrame& result) {
  Implementation& self = *implementation_;
  FrameReport& report = result.report;
  expect_sizes(frame, self.rig);
  self.begin(frame, result);
  self.texture.begin_frame();
  if (report.skipped) return;

  {  // 3.2 Camera poses
    const ScopedTimer timer(report.milliseconds, Stage::poses);
    self.find_markers(frame, report.markers);
    self.camera_poses.estimate(frame, report.markers, report.poses);
  }
  {  // 3.2 Objects to remove
    const ScopedTimer timer(report.milliseconds, Stage::detection);
    self.occluders.detect({frame, report.markers, report.poses, self.options}, report.occluders);
  }
  if (!self.occluders.message().empty()) report.messages.push_back(self.occluders.message());
  Reach reach = Reach::reconstruction;
  {  // 3.3 Reconstruction of what is behind them
    const ScopedTimer timer(report.milliseconds, Stage::reconstruction);
    reach = self.reconstruct(frame, result);
  }
  if (!self.backend.message().empty()) report.messages.push_back(self.backend.message());
  // 3.4 Compositing, colour correction, inpainting
  const Mask& occlusion = self.occluders.masks().color;
  if (reach == Reach::reconstruction) {
    self.compositor.composite(frame.color, occlusion, self.occluders.objects(), self.options,
                              result);
  } else if (reach == Reach::seen) {
    self.compositor.complete(frame.color, occlusion, self.occluders.objects(), self.options,
                             result);
  }
  self.texture.finish_frame(reach == Reach::picture, result);

  for (const std::string& message : report.poses.messages) report.messages.push_back(message);
  for (const OccluderReport& occluder : report.occluders) {
    if (!occluder.message.empty()) report.messages.push_back(occluder.message);
  }
}

}  // namespace diminish
