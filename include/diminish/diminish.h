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
///
/// Or a program's own images, where they are, here a cv::Mat of CV_8UC3:
///
///   frame.color = diminish::ImageView<diminish::Bgr>(mat.ptr<diminish::Bgr>(), mat.cols, mat.rows,
///                                                    static_cast<std::ptrdiff_t>(mat.step));

#include "diminish/board.h"
#include "diminish/calibration.h"
#include "diminish/camera_source.h"
#include "diminish/color_corrector.h"
#include "diminish/color_map.h"
#include "diminish/config.h"
#include "diminish/depth_estimator.h"
#include "diminish/diminished_frame.h"
#include "diminish/error.h"
#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/frame_sink.h"
#include "diminish/frame_source.h"
#include "diminish/gl_texture.h"
#include "diminish/gpu_pass.h"
#include "diminish/image.h"
#include "diminish/inpainter.h"
#include "diminish/input_image.h"
#include "diminish/intrinsics.h"
#include "diminish/live.h"
#include "diminish/marker_detector.h"
#include "diminish/marker_sheet.h"
#include "diminish/objects_of_detector.h"
#include "diminish/occluder_detector.h"
#include "diminish/occluder_settings.h"
#include "diminish/occlusion_masks.h"
#include "diminish/options.h"
#include "diminish/pipeline.h"
#include "diminish/pose_source.h"
#include "diminish/poses.h"
#include "diminish/reconstruction.h"
#include "diminish/reconstructor.h"
#include "diminish/recording_writer.h"
#include "diminish/registry.h"
#include "diminish/remote_images.h"
#include "diminish/report.h"
#include "diminish/result_writer.h"
#include "diminish/rig.h"
#include "diminish/rig_calibration.h"
#include "diminish/rigid_transform.h"
#include "diminish/rim_line.h"
#include "diminish/ros2_output.h"
#include "diminish/runner.h"
#include "diminish/scan.h"
#include "diminish/scene.h"
#include "diminish/scene_samples.h"
#include "diminish/score.h"
#include "diminish/setup_check.h"
#include "diminish/stage.h"
#include "diminish/surfaces.h"
#include "diminish/tiled_region.h"
#include "diminish/validate.h"
#include "diminish/view_mode.h"
#include "diminish/virtual_camera.h"
#include "diminish/web_server.h"
