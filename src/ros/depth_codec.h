#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "diminish/image.h"

namespace diminish::ros {

/// Compresses depth without loss, row by row as one sequence: runs of pixels without a measurement,
/// and between them differences from pixel to pixel, in groups of three bits and one that says
/// whether more follow. Source: A. Wilson, Fast Lossless Depth Image Compression (RVL), ISS 2017.
/// The bytes are those of ROS's compressedDepth with `rvl`. Appends to `bytes`. Cost: one pass;
/// docs/many-machines.md has figures.
void compress_depth(const ImageView<std::uint16_t>& depth, std::vector<std::uint8_t>& bytes);

/// The opposite, into an image that has its size already. Throws Error (input) where the bytes do
/// not hold exactly its pixels.
void decompress_depth(std::span<const std::uint8_t> bytes, Image<std::uint16_t>& depth);

}  // namespace diminish::ros
