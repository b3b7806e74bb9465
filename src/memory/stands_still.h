#pragma once

#include "memory/testimony.h"

namespace diminish {

/// Whether an RGB-D camera has not been moved from one testimony to another: most of what it
/// measured both times is at the same depth and, but for the light, of the same colour. Cost: 2 us.
bool stands_still(const Testimony& then, const Testimony& now);

}  // namespace diminish
