#pragma once

#include <vector>

#include "diminish/color_map.h"
#include "diminish/frame_set.h"
#include "diminish/rig.h"
#include "diminish/scene_samples.h"

namespace diminish {

/// How much of the change that ColorSmoothing makes is right in this frame, 0 to
/// ColorSmoothing::whole_change: it takes out noise, but also fine texture. Where there are no
/// objects, the colour camera's picture is the truth with noise of its own. The share is the one
/// that brings what the RGB-D cameras see closest to it, by least squares, plus its standard error:
/// all for noisy cameras, and next to nothing for clean textured pictures. All if too little is
/// seen. What is compared is each pixel against its surroundings, because light differs otherwise,
/// too.
/// occlusion: where the colour camera shows objects to remove. maps: by SceneSample::source. Cost:
/// 1 us per sample, of which it takes three hundred.
int smoothing_share(const Rig& rig, const FrameSet& frame, const Mask& occlusion,
                    const std::vector<SceneSample>& samples, ColorMapsBySource maps);

}  // namespace diminish
