#pragma once

/// \file
/// All of diminish. A recording in, pictures out:
///
///   auto recording = diminish::load_recording("calendar");
///   diminish::Options options;
///   auto source = diminish::open_recording(recording, options);
///   diminish::Pipeline pipeline(recording.rig, recording.scene, options);
///   diminish::FrameSet frame;
///   diminish::DiminishedFrame result;
///   while (source->next(frame)) pipeline.process(frame, result);

#include "diminish/color_corrector.h"
#include "diminish/diminished_frame.h"
#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "diminish/gl_texture.h"
#include "diminish/inpainter.h"
#include "diminish/marker_detector.h"
#include "diminish/occluder_detector.h"
#include "diminish/options.h"
#include "diminish/pipeline.h"
#include "diminish/pose_source.h"
#include "diminish/reconstructor.h"
#include "diminish/rig.h"
#include "diminish/scene.h"
#include "diminish/view_mode.h"
