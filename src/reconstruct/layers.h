#pragma once

#include <vector>

#include "diminish/reconstruction.h"
#include "reconstruct/rasterizer.h"

namespace diminish {

/// Merges what several RGB-D cameras show into one picture. Where two surfaces agree within
/// `agreement_m` they are one, and the camera that sees more of the region is taken: a choice that
/// is the same all over a surface, so that noise does not make it speckle. Otherwise the nearer
/// surface hides the other.
/// layers: one per RGB-D camera; null for those that take no part.
void merge_layers(const std::vector<const Layer*>& layers, float agreement_m,
                  Reconstruction& reconstruction);

}  // namespace diminish
