#pragma once

#include "setup/check/diagnosis.h"

namespace diminish {

// What `check_setup` looks at. Each adds what it finds to the diagnosis, and corrects there what it
// blames, so that what follows from it is not complained of again.

void check_streams(Diagnosis& setup);
void check_exposure(Diagnosis& setup);
void check_markers(Diagnosis& setup);
/// Of markers, by which sizes, depth units and focal lengths show.
void check_depth(Diagnosis& setup);
/// Whether the cameras agree on where markers are.
void check_between_cameras(Diagnosis& setup);
/// Of the colour camera: no depth of its own says how far its markers are, but the pictures agree
/// only with the right one.
void check_focal_length(Diagnosis& setup);
void check_clocks(Diagnosis& setup);

}  // namespace diminish
