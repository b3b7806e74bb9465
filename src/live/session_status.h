#pragma once

#include "diminish/live.h"

namespace diminish {

/// Without a picture for this long, the status says so.
inline constexpr double no_picture_after_s = 1;

/// Adds to `status.problems` what is wrong with the cameras. Returns whether the user's is at its
/// end.
bool describe_problems_of_cameras(LiveStatus& status);

/// Fills what the last frame says, after the cameras' states.
void describe_last_frame(const LiveFrame& frame, LiveStatus& status);

}  // namespace diminish
