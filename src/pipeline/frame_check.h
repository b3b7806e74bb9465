#pragma once

#include "diminish/frame_set.h"
#include "diminish/rig.h"

namespace diminish {

/// Throws Error if a frame's images do not have the rig's sizes. Those of frame sources do; those
/// of a program's own frames may not.
void expect_sizes(const FrameSet& frame, const Rig& rig);

}  // namespace diminish
