#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "diminish/error.h"
#include "ros/depth_codec.h"

using namespace diminish;

/// The first byte is the image's width. The rest is read as a compressed image, and compressed and
/// read again as pixels.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1 || data[0] == 0) return 0;
  const int width = data[0];
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  Image<std::uint16_t> depth(width, 16);
  try {
    ros::decompress_depth(bytes, depth);
  } catch (const Error&) {
  }
  const int height = static_cast<int>(bytes.size() / 2) / width;
  Image<std::uint16_t> pixels(width, height);
  if (!pixels.empty()) std::memcpy(pixels.data(), bytes.data(), pixels.size() * 2);
  std::vector<std::uint8_t> compressed;
  ros::compress_depth(pixels, compressed);
  Image<std::uint16_t> back(width, height);
  ros::decompress_depth(compressed, back);
  if (!(back == pixels)) std::abort();
  return 0;
}
