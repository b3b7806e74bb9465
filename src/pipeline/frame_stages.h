#pragma once

#include <atomic>
#include <tuple>

#include "bars/depth_gaps.h"
#include "blend/scraps.h"
#include "composite/compositor.h"
#include "depth/camera_choice.h"
#include "depth/depth_stage.h"
#include "detect/occlusion_masks.h"
#include "estimate/depth_estimation.h"
#include "memory/memory_stage.h"
#include "pipeline/backend.h"
#include "pipeline/doubt.h"
#include "pipeline/frame_texture.h"
#include "pipeline/inventions.h"
#include "pipeline/methods.h"
#include "pipeline/set_up_evidence.h"
#include "pose/camera_poses.h"
#include "pose/frame_markers.h"
#include "pose/pose_refinement.h"
#include "scene/background.h"
#include "scene/color_maps.h"
#include "scene/contact_line.h"
#include "scene/scene_sampler.h"

namespace diminish {

/// The stages, with what they have made of this frame.
struct FrameStages {
  FrameStages(const Rig& rig_, const Scene& scene_);

  void set_options(const Options& wanted);

  int surroundings_px() const;
  /// The part of the picture around the objects that is reconstructed.
  Rect surroundings() const;
  /// Whether anything is to be drawn. A shadow may be in view without its object.
  bool looks_at_scene() const;
  Background::Wanted wanted_background() const;
  void find_contact_line(const FrameSet& frame);
  void choose_region();
  void narrow_region();
  /// Those that add nothing to what is drawn get no pose.
  void spare_cameras(const FrameSet& frame, FrameReport& report);
  void refine_poses(const FrameSet& frame, Poses& poses);
  void find_smoothing(const FrameSet& frame);

  /// All stages. The caller has taken the frame's turn in what is shared.
  void process(const FrameSet& frame, DiminishedFrame& result);
  /// What the frames of one sequence share, each in its turn.
  auto shared() {
    return std::tie(memory, occluders, doubt, evidence.delay(), inventions.steady(),
                    inventions.known_bars());
  }

  Rig rig;
  Scene scene;
  Options options;
  Methods<ColorCorrector> correctors;
  Methods<Inpainter> inpainters;
  Methods<ViewMode> modes;
  ColorCorrector* corrector = nullptr;  ///< what the options name
  Inpainter* inpainter = nullptr;
  const ViewMode* mode = nullptr;
  FrameMethods methods;

  DepthEstimation estimation;
  CameraPoses camera_poses;
  OccluderStage occluders;
  FrameMarkers markers;
  Poses measured_poses;
  CameraChoice choice;
  DepthStage depth;
  SceneSampler sampler;
  SceneSamples samples;
  PoseRefinement refinement;
  SetUpEvidence evidence;
  Background background;
  ContactLine contact_line;
  ColorMaps color_maps;
  TiledRegion region;  ///< to be drawn
  Backend backend;
  MemoryStage memory;
  Compositor compositor;
  BarViews views;
  Scraps scraps;
  DepthGaps gaps;
  Inventions inventions;
  Doubt doubt;
  FrameTexture texture;
  int smoothing = 0;  ///< the share of smoothed colours
  bool wants_reconstruction = true;
  static constexpr int no_stage = -1;
  std::atomic<int> begun_stage = no_stage;
};

}  // namespace diminish
