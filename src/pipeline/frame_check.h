#pragma once

#include "diminish/frame_set.h"
#include "diminish/rig.h"

namespace diminish {

/// Throws Error where a frame's images are not of the rig's sizes. Frame sources deliver such; a
/// program that makes its own frames may not.
void expect_sizes(const FrameSet& frame, const Rig& rig);

}  // namespace diminish
