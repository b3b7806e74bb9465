#include "source/image_header.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace diminish {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// Of `count` bytes at `offset`, which are there.
std::uint32_t number_at(Bytes bytes, std::size_t offset, std::size_t count) {
  return big_endian(bytes.subspan(offset, count));
}

template <std::size_t size>
bool starts_with(Bytes bytes, const std::array<std::uint8_t, size>& magic) {
  return bytes.size() >= size && std::equal(magic.begin(), magic.end(), bytes.begin());
}

std::optional<cv::Size> size_of(std::uint32_t width, std::uint32_t height) {
  constexpr std::uint32_t most = 0x7fffffff;
  if (width == 0 || height == 0 || width > most || height > most) return std::nullopt;
  return cv::Size(static_cast<int>(width), static_cast<int>(height));
}

std::optional<cv::Size> size_of_png(Bytes bytes) {
  constexpr std::size_t width_at = 16;
  constexpr std::size_t height_at = 20;
  if (bytes.size() < height_at + 4) return std::nullopt;
  return size_of(number_at(bytes, width_at, 4), number_at(bytes, height_at, 4));
}

std::optional<cv::Size> size_of_jpeg(Bytes bytes) {
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && bytes[at] == 0xff) {
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xff) {  // a fill byte
      ++at;
      continue;
    }
    // SOF0 to SOF15, between which DHT, JPG and DAC stand.
    const bool is_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) {
      if (at + 9 > bytes.size()) return std::nullopt;
      return size_of(number_at(bytes, at + 7, 2), number_at(bytes, at + 5, 2));
    }
    at += 2 + number_at(bytes, at + 2, 2);
  }
  return std::nullopt;
}

}  // namespace

bool is_png(std::span<const std::uint8_t> bytes) {
  return starts_with<8>(bytes, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'});
}

bool is_jpeg(std::span<const std::uint8_t> bytes) {
  return starts_with<2>(bytes, {0xff, 0xd8});
}

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t number = 0;
  for (const std::uint8_t byte : bytes) number = number << 8 | byte;
  return number;
}

std::optional<cv::Size> declared_size(std::span<const std::uint8_t> bytes) {
  if (is_png(bytes)) return size_of_png(bytes);
  if (is_jpeg(bytes)) return size_of_jpeg(bytes);
  return std::nullopt;
}

}  // namespace diminish
