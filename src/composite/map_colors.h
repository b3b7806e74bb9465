#pragma once

#include <vector>

#include "diminish/image.h"
#include "diminish/reconstruction.h"
#include "membrane/soft_membrane.h"
#include "scene/color_map.h"

namespace diminish {

/// Writes row y of `picture` wherever an object is to be removed and the reconstruction has a
/// colour: that colour, mapped, plus `correction`. Where a second camera sees the same surface,
/// mixes in that camera's colour, mapped by its own map.
/// correction: by SoftMembrane::row.
void map_colors(ColorMapsBySource maps, const Reconstruction& reconstruction, const Mask& occlusion,
                int y, const SoftMembrane::Node* correction, Image<Bgr>& picture);

}  // namespace diminish
