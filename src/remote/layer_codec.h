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

/// Colours where `inverse_z` is not 0, without loss: green, and blue and red less green, by
/// ros::compress_depth. (PNG is smaller by a tenth and takes ten times as long.)
void compress_color(const Image<Bgr>& color, const Image<float>& inverse_z,
                    std::vector<std::uint8_t>& bytes);
/// color: has its size already; unspecified where `inverse_z` is 0.
void decompress_color(std::span<const std::uint8_t> bytes, const Image<float>& inverse_z,
                      Image<Bgr>& color);

/// As a JPEG. Where `inverse_z` is 0, `color` is filled from its neighbours, which costs fewer
/// bytes than an edge would.
void compress_jpeg(Image<Bgr>& color, const Image<float>& inverse_z, int quality,
                   std::vector<std::uint8_t>& bytes);
void decompress_jpeg(std::span<const std::uint8_t> bytes, Image<Bgr>& color);

/// Words without loss; runs of 0 cost next to nothing. Small where words change evenly along rows
/// and columns, as the bits of 1 / z do on a surface.
void compress_words(const Image<std::uint32_t>& words, std::vector<std::uint8_t>& bytes);
/// words: has its size already.
void decompress_words(std::span<const std::uint8_t> bytes, Image<std::uint32_t>& words);
/// The same for numbers that are 0 or at least a millionth.
void compress_exactly(const Image<float>& values, std::vector<std::uint8_t>& bytes);
void decompress_exactly(std::span<const std::uint8_t> bytes, float most, Image<float>& values);
/// Throws Error (input) unless all are such numbers, of at most `most`.
void expect_numbers(const Image<float>& values, float most);

/// RemoteLayer::inverse_z as depth in steps of `unit_m`, or of what 16 bits need to reach far
/// enough. Returns the step.
double compress_inverse_z(const Image<float>& inverse_z, double unit_m,
                          std::vector<std::uint8_t>& bytes);
/// inverse_z: has its size already.
void decompress_inverse_z(std::span<const std::uint8_t> bytes, double unit_m,
                          Image<float>& inverse_z);

/// RemoteLayer::resolution in steps of 1 / 4096, which is less than blending can show.
void compress_resolution(const Image<float>& resolution, std::vector<std::uint8_t>& bytes);
/// resolution: has its size already.
void decompress_resolution(std::span<const std::uint8_t> bytes, Image<float>& resolution);

/// The lengths of runs of clear and set pixels in turn, seven bits a byte.
void compress_mask(const Mask& mask, std::vector<std::uint8_t>& bytes);
/// mask: has its size already.
void decompress_mask(std::span<const std::uint8_t> bytes, Mask& mask);

}  // namespace diminish
