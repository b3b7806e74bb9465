#pragma once

#include <vector>

#include "diminish/image.h"

namespace diminish {

/// The colours of provenance pictures, by value: grey for the camera's own pixels, one colour for
/// each RGB-D camera, magenta for inpainted, black for unknown.
const std::vector<Bgr>& provenance_palette();

}  // namespace diminish
