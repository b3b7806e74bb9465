#pragma once

#include <filesystem>
#include <string>

#include "analytic_scene.h"
#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "paths.h"

namespace diminish::testing {

/// A bundled recording's first frame and its result.
struct FirstFrame {
  explicit FirstFrame(const std::string& name)
      : recording(load_recording(std::filesystem::path(testing::recordings_dir()) / name)) {
    open_recording(recording, options)->next(frame);
    Pipeline(recording.rig, recording.scene, options).process(frame, result);
    depths = depths_of(frame);
    masks = empty_masks(recording.rig);
  }

  const Rig& rig() const { return recording.rig; }
  TiledRegion whole_view() const { return recording.rig.color.bounds(); }
  /// The tiles around two slender objects.
  TiledRegion tiled_part() const {
    Mask objects(rig().color.width, rig().color.height, 0);
    for (int i = 0; i < 300; ++i) objects(250 + 2 * i, 200 + i) = objects(700 - i, 420) = 255;
    TiledRegion region(Rect{240, 190, 621, 333});
    region.keep_near(objects, 16);
    return region;
  }

  /// Reconstructs with the pipeline's poses and these `depths` and `masks`.
  void reconstruct(Reconstructor& reconstructor, const TiledRegion& region,
                   Reconstruction& reconstruction) const {
    reconstructor.reconstruct(frame, depths, result.report.poses, masks, region, options,
                              reconstruction);
  }

  /// A rectangle in each of the RGB-D cameras' masks.
  void mask_parts() {
    for (Mask& mask : masks.rgbd_depth) mask.fill({100, 50, 97, 61}, 255);
    for (Mask& mask : masks.rgbd_color) mask.fill({500, 400, 333, 222}, 255);
  }

  Recording recording;
  Options options;
  FrameSet frame;
  DiminishedFrame result;
  DepthImages depths;    ///< as they are recorded
  OcclusionMasks masks;  ///< at first with nothing in them
};

}  // namespace diminish::testing
