#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "diminish/diminished_frame.h"
#include "diminish/scan.h"
#include "memory/keyframe.h"

namespace diminish {

// Keyframes as the frames of a scan, and back.

/// Scan::rig for a rig.
Rig scan_rig(const Rig& rig);

/// RGB-D cameras that saw nothing are left out.
Scan make_scan(const std::vector<std::shared_ptr<Keyframe>>& keyframes, const Rig& rig,
               const Scene& scene);

/// Adds another camera to a scan: what the RGB-D cameras saw behind the objects, from the colour
/// camera's viewpoint. results: of these frames, by a pipeline without memory.
void add_behind(const std::function<const DiminishedFrame&(std::size_t frame)>& results,
                Scan& scan);

/// rig: of the cameras that look now. The testimonies of those that are not the scan's are not
/// given. If there are none of the scan's, what these saw behind the objects is part of the
/// keyframes. Throws Error if the scan is not of the rig's colour camera, or its world is not the
/// one that the rig's pose source knows.
std::vector<Keyframe> keyframes_of(const Scan& scan, const Rig& rig, const Scene& scene);

/// Throws Error if the poses that the rig's source finds are not in a world that another recording
/// can share.
void expect_world(const Rig& rig);

}  // namespace diminish
