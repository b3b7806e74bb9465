#pragma once

#include "diminish/config.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

// The checks that files and programs' own structures have in common. `place` is where what is
// checked stands in a file, or nothing: Config names the keys of that, too.

/// A rigid transform's rows may be off by as much.
inline constexpr double rotation_tolerance = 1e-3;
inline constexpr int min_image_side = 8;
inline constexpr int max_image_side = 16384;
inline constexpr int max_marker_id = 65535;

void check_rig(const Rig& rig, const Config& place);
void check_scene(const Scene& scene, const Rig* rig, const Config& place);
void check_marker(const MarkerSpec& marker, const Config& place);
/// Whether the matrix is a rotation, and the translation in metres.
void check_rigid_transform(const RigidTransform& transform, const Config& place);

/// The list's item of this index, also of a list that is not there.
Config item_of(const Config& list, std::size_t index);

}  // namespace diminish
