#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "diminish/image.h"
#include "diminish/remote_images.h"

namespace diminish {

// How images and masks travel between the user's machine and a node. Writers append. Readers throw
// Error (input) where the bytes are not those of an image of this size; nothing is allocated for
// what they claim.

/// Colours where `depth` is not 0, without loss: green, and blue and red less green, by
/// ros::compress_depth. (PNG is smaller by a tenth and takes ten times as long.)
void compress_color(const Image<Bgr>& color, const Image<std::uint16_t>& depth,
                    std::vector<std::uint8_t>& bytes);
/// color: has its size already; unspecified where `depth` is 0.
void decompress_color(std::span<const std::uint8_t> bytes, const Image<std::uint16_t>& depth,
                      Image<Bgr>& color);

/// As a JPEG. Where `depth` is 0, `color` is filled from its neighbours, which costs fewer bytes
/// than an edge would.
void compress_jpeg(Image<Bgr>& color, const Image<std::uint16_t>& depth, int quality,
                   std::vector<std::uint8_t>& bytes);
void decompress_jpeg(std::span<const std::uint8_t> bytes, Image<Bgr>& color);

/// RemoteLayer::resolution in steps of 1 / 4096, which is less than blending can show.
void compress_resolution(const Image<float>& resolution, std::vector<std::uint8_t>& bytes);
/// resolution: has its size already.
void decompress_resolution(std::span<const std::uint8_t> bytes, Image<float>& resolution);

/// The lengths of runs of clear and set pixels in turn, seven bits a byte.
void compress_mask(const Mask& mask, std::vector<std::uint8_t>& bytes);
/// mask: has its size already.
void decompress_mask(std::span<const std::uint8_t> bytes, Mask& mask);

}  // namespace diminish
