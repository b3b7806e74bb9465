#include "pipeline/frame_stages.h"

#include <algorithm>
#include <functional>

#include "composite/smoothing_share.h"
#include "core/tasks.h"
#include "diminish/remote_images.h"
#include "pipeline/frame_check.h"
#include "pipeline/stage_timer.h"

namespace diminish {
namespace {

/// A result without anything of an earlier frame. A skipped frame's images are empty.
void begin(const FrameSet& frame, DiminishedFrame& result) {
  result.name = frame.name;
  result.index = frame.index;
  result.stamp_s = frame.stamp_s;
  result.surfaces.standing_depth_m.resize(0, 0);
  FrameReport& report = result.report;
  report.mask_pixels = report.valid_pixels = report.missing_pixels = 0;
  report.witnessed_pixels = report.remembered_pixels = report.estimated_pixels = 0;
  report.fit.clear();
  report.in_doubt = false;
  report.memory = {};
  report.milliseconds.fill(0);
  report.frame_ms = 0;
  report.drawing.milliseconds = 0;
  report.drawing.device.clear();
  report.drawing.passes.clear();
  report.skipped = frame.color.empty();
  report.faults = frame.faults;
  report.messages.clear();
  for (const RgbdFrame& rgbd : frame.rgbd) {
    if (!rgbd.missing.empty()) report.messages.push_back(rgbd.missing);
  }
  if (!report.skipped) return;
  report.markers = {};
  report.poses = {};
  report.occluders.clear();
  result.picture = {};
  result.mask = {};
  result.provenance = {};
  result.objects = {};
  result.reconstruction = {};
  result.surfaces = {};
}

}  // namespace

FrameStages::FrameStages(const Rig& rig_, const Scene& scene_)
    : rig(rig_),
      scene(scene_),
      estimation(rig, scene),
      camera_poses(rig, scene),
      occluders(rig, scene),
      markers(
          rig, scene.marker_dictionary,
          camera_poses.needs_markers() || occluders.needs_markers() || estimation.needs_markers()),
      choice(rig),
      depth(rig),
      sampler(rig),
      refinement(rig.color, {.coarser = PoseRefinement::usual_coarser}),
      evidence(rig, scene),
      background(rig.color),
      contact_line(rig.color),
      backend(rig),
      memory(rig),
      views(rig),
      gaps(rig),
      inventions(rig) {}

void FrameStages::set_options(const Options& wanted) {
  check(wanted, rig, scene);
  estimation.choose(wanted.estimate_depth);
  backend.choose(wanted.backend);
  occluders.draw_by(backend.mask_drawer());
  options = wanted;
  corrector = &correctors.get(options.color_correct);
  inpainter = &inpainters.get(options.inpaint);
  mode = &modes.get(options.mode);
  methods = {corrector->declaration(), inpainter->declaration(), options.mode,
             options.memory != "off"};
  const Inpainter::Declaration inpainting = methods.inpainting;
  inventions.choose({.lines = inpainting.uses_lines,
                     .sides = options.complete_sides && inpainting.uses_surfaces,
                     .bars = options.draw_bars && inpainting.uses_surfaces && !rig.rgbd.empty(),
                     .grain = inpainting.wants_grain,
                     .steady = methods.remembers});
}

/// The mask may still grow by the objects' contact line.
int FrameStages::surroundings_px() const {
  return std::max(options.surroundings_px, options.contact_line_px + 1);
}

Rect FrameStages::surroundings() const {
  const Rect whole = rig.color.bounds();
  if (options.whole_view) return whole;
  return intersect(grow(occluders.objects(), surroundings_px()), whole);
}

bool FrameStages::looks_at_scene() const {
  return options.whole_view || options.remove_shadows || !occluders.objects().empty();
}

Background::Wanted FrameStages::wanted_background() const {
  const bool shadows = options.lift_shadows || options.remove_shadows;
  return {shadows || methods.inpainting.uses_surfaces, shadows, options.refine_shadows};
}

void FrameStages::find_contact_line(const FrameSet& frame) {
  if (!background.planes()) return;
  contact_line.find({frame.color, occluders.masks().color, occluders.vertices_m(),
                     *background.planes(), options.mask_margin_px, options.contact_line_px});
}

void FrameStages::choose_region() {
  region.set(surroundings());
  if (options.remove_shadows) {
    region.set(rig.color.bounds());
  } else if (!options.whole_view) {
    region.keep_near(occluders.masks().color, surroundings_px());
  }
}

/// Shadows to remove may be anywhere until they are known.
void FrameStages::narrow_region() {
  if (options.remove_shadows) region.set(join(surroundings(), background.shaded_part()));
}

void FrameStages::spare_cameras(const FrameSet& frame, FrameReport& report) {
  report.spared.clear();
  if (options.whole_view || options.remove_shadows || occluders.objects().empty()) return;
  report.spared = choice.find_spared(frame, measured_poses, occluders.masks(), occluders.objects());
  for (std::size_t k = 0; k < report.spared.size(); ++k) {
    if (report.spared[k]) measured_poses.color_from_depth[k].reset();
  }
}

void FrameStages::refine_poses(const FrameSet& frame, Poses& poses) {
  if (!options.refine_poses) return;
  const auto correction = refinement.refine(frame, occluders.masks().color, samples);
  if (correction) refinement.apply(*correction, poses, samples);
}

void FrameStages::find_smoothing(const FrameSet& frame) {
  if (!options.smooth_colors || occluders.objects().empty()) return;
  smoothing = smoothing_share(rig, frame, occluders.masks().color, samples.surfaces,
                              color_maps.by_source());
}

// Meerits & Saito 2015, section 3, in its order.
void FrameStages::process(const FrameSet& given, DiminishedFrame& result) {
  FrameReport& report = result.report;
  expect_sizes(given, rig);
  const FrameSet& frame = estimation.begin(given);
  begin(frame, result);
  texture.begin_frame();
  backend.begin_frame();
  if (report.skipped) return;

  const ScopedTimer frame_timer(report.frame_ms);
  const auto stage = [&](Stage which, const auto& work) {
    if (backend.has_done(which)) return;
    begun_stage = static_cast<int>(which);
    const tracing::Scope scope(stage_names[static_cast<std::size_t>(which)]);
    const ScopedTimer timer(report.milliseconds[static_cast<std::size_t>(which)]);
    work();
  };
  const OcclusionMasks& masks = occluders.masks();
  const Rect& objects = occluders.objects();

  // 3.2 Camera poses, objects to remove
  stage(Stage::poses, [&] {
    markers.find(frame, report.markers);
    camera_poses.estimate(frame, report.markers, measured_poses);
  });
  stage(Stage::objects, [&] {
    occluders.detect({frame, report.markers, measured_poses, options}, report.occluders);
  });

  // 3.3 Reconstruction of what is behind them, for which the scene has to be known
  spare_cameras(frame, report);
  report.poses = measured_poses;
  background.clear();
  contact_line.clear();
  const bool closes_gaps = options.close_gaps && !objects.empty();
  bool has_gap_shadows = false;
  const auto find_gap_shadows = [&] {
    if (!closes_gaps || has_gap_shadows) return;
    gaps.find_shadows(
        {views, frame, report.poses, masks, samples.surfaces, color_maps.by_source()});
    has_gap_shadows = true;
  };
  const auto learn = [&] {
    views.begin(frame, report.poses, masks);
    do_all(
        [&] {
          stage(Stage::background, [&] {
            background.find(objects, samples, wanted_background());
            find_contact_line(frame);
          });
        },
        [&] {
          stage(Stage::color_maps, [&] {
            color_maps.fit(frame.color, masks.color, samples.surfaces, methods.color.maps);
            find_smoothing(frame);
          });
          if (backend.only_draws()) stage(Stage::compositing, find_gap_shadows);
        });
  };
  FrameInputs drawing{frame,   depth.depths(), report.poses, masks,
                      objects, region,         options,      methods};
  drawing.wants_reconstruction = wants_reconstruction;
  drawing.texture = texture.output();
  const auto draw = [&] { stage(Stage::drawing, [&] { backend.draw(drawing, result); }); };
  // Not in the paper: what the cameras saw earlier
  const RecallInputs recalling{
      frame,  report.poses, masks,           objects,
      region, options,      report.in_doubt, estimation.own_planes(report.markers, report.poses)};
  const bool looks = looks_at_scene();
  const auto sample = [&] {
    stage(Stage::samples, [&] { sampler.sample(frame, measured_poses, masks, samples); });
    stage(Stage::refinement, [&] { refine_poses(frame, report.poses); });
  };
  // Nothing that is drawn waits for this; what is learnt from the frame does.
  const auto judge = [&] {
    stage(Stage::refinement, [&] {
      evidence.judge({frame, measured_poses, masks, samples, options, methods.remembers},
                     refinement, report);
    });
  };
  const auto estimate = [&](const Rect& part) {
    stage(Stage::estimation,
          [&] { estimation.estimate(report.markers, measured_poses, masks, part, options); });
  };
  const auto recall = [&] {
    stage(Stage::memory, [&] {
      if (methods.remembers) memory.recall(recalling);
    });
  };
  const auto remember = [&] {
    stage(Stage::memory, [&] {
      if (!methods.remembers) return;
      // Where nothing is drawn, depth is estimated and samples are taken only for a keyframe.
      const auto sample_now = [&] {
        estimate(rig.color.bounds());
        sample();
        judge();
      };
      // Held by reference, it allocates nothing.
      std::function<void()> sample_later;
      if (!looks) sample_later = std::ref(sample_now);
      memory.learn(recalling, samples, report.occluders, sample_later, report.memory);
    });
  };
  const auto prepare = [&] {
    stage(Stage::inpainting, [&] { inventions.find_lines(frame, masks.color, objects); });
  };
  // What is learnt of the scene may be needed only after the drawing: then both are done together.
  choose_region();
  if (looks) estimate(region);
  const bool learns_while_drawing = looks && backend.only_draws() && !options.remove_shadows;
  if (looks) {
    do_all(
        [&] {
          stage(Stage::depth, [&] { depth.clean(frame, measured_poses, masks, region, options); });
        },
        [&] {
          sample();
          if (!learns_while_drawing) learn();
        });
  }
  const auto judge_and_recall = [&] {
    do_all(
        [&] {
          if (looks) judge();
        },
        recall);
    remember();  // what is in doubt is not learnt from
  };
  narrow_region();
  // Nobody may read the masks meanwhile.
  const auto add_contact_line = [&] { occluders.add(contact_line.pixels()); };
  if (learns_while_drawing) {
    do_all(judge_and_recall, draw, learn, prepare);
    add_contact_line();
  } else {
    add_contact_line();
    drawing.objects = objects;
    drawing.planes = background.planes();
    drawing.shadows = background.shadows();
    drawing.color_maps = color_maps.by_source();
    drawing.smoothing_share = smoothing;
    do_all(judge_and_recall, draw);
    prepare();
  }
  stage(Stage::merging, [&] {
    if (options.remove_scraps && !objects.empty()) {
      scraps.remove(masks.color, grow(objects, surroundings_px()),
                    {options.discontinuity_threshold_m, options.discontinuity_reach_m},
                    result.reconstruction);
    }
    if (!methods.remembers) return;
    memory.merge(recalling, color_maps.by_source(), result.reconstruction, report.memory);
    Doubt::judge_background(memory.background_fit(), options, report);
  });

  // 3.4 Compositing, colour correction, inpainting; a backend may have done these
  const Compositor::Inputs inputs{frame.color, masks.color, objects,
                                  options,     smoothing,   inventions.lines()};
  stage(Stage::compositing, [&] {
    if (closes_gaps) {
      find_gap_shadows();  // if a GPU was to compose
      gaps.draw({views, frame, report.poses, masks, samples.surfaces, color_maps.by_source()},
                grow(objects, surroundings_px()), result.reconstruction);
    }
    background.label(result.reconstruction, result.surfaces);
    Compositor::sort(inputs, result);
  });
  const auto correct_colors = [&] {
    stage(Stage::colors, [&] {
      compositor.correct_colors(inputs, color_maps.by_source(), *corrector, result);
      compositor.lift_shadows(inputs, background.shadows(), samples, result);
    });
  };
  // Of what is behind the objects. Shadows need the planes' labels meanwhile.
  const Inventions::Inputs inventing{frame,   report.poses, masks, objects, background.planes(),
                                     samples, views};
  if (inventions.looks_for_structure(inventing)) {
    do_all([&] { stage(Stage::inpainting, [&] { inventions.find_structure(inventing, result); }); },
           correct_colors);
  } else {
    correct_colors();
  }
  stage(Stage::inpainting,
        [&] { inventions.fill(inventing, inputs, compositor, *inpainter, result); });
  stage(Stage::finish, [&] { compositor.finish(inputs, *mode, result); });

  for (const std::string* message : {&occluders.message(), &backend.message()}) {
    if (!message->empty()) report.messages.push_back(*message);
  }
  for (const RgbdFrame& rgbd : frame.rgbd) {
    if (rgbd.is_remote() && !rgbd.remote->problem().empty()) {
      report.messages.push_back(rgbd.remote->problem());
    }
  }
  const bool is_replaced = doubt.act(frame, options, result);
  texture.finish_frame(backend.has_done(Stage::finish) && !is_replaced, result);
  if (rig.rgbd.empty() && scene.planes.empty() && report.poses.color_from_world &&
      report.memory.keyframes == 0) {
    report.messages.emplace_back(
        "no RGB-D camera, no background (diminish scan), no planes: what is hidden is invented");
  }
  for (const std::string& message : estimation.messages()) report.messages.push_back(message);
  for (const std::string& message : report.poses.messages) report.messages.push_back(message);
  for (const OccluderReport& occluder : report.occluders) {
    if (!occluder.message.empty()) report.messages.push_back(occluder.message);
  }
}

}  // namespace diminish
