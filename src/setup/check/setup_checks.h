#pragma once

#include "setup/check/diagnosis.h"

namespace diminish {

// The checks of `check_setup`. Each adds its findings to the diagnosis and corrects what it blames
// there, so that the consequences are not reported again.

void check_streams(Diagnosis& setup);
void check_exposure(Diagnosis& setup);
void check_markers(Diagnosis& setup);
/// Depth on markers, which shows wrong sizes, depth units and focal lengths.
void check_depth(Diagnosis& setup);
/// Whether the cameras agree on where markers are.
void check_between_cameras(Diagnosis& setup);
/// The colour camera's focal length. It has no depth to say how far its markers are, but the
/// pictures agree only with the right focal length.
void check_focal_length(Diagnosis& setup);
void check_clocks(Diagnosis& setup);
/// Whether the refinement of poses moves the colour camera the same way in every frame: that is a
/// wrong calibration, not noise.
void check_pose_bias(Diagnosis& setup);

}  // namespace diminish
