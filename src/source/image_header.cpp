#include "source/image_header.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace diminish {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// The big-endian number of `count` bytes at `offset`, which are there.
std::uint32_t number_at(Bytes bytes, std::size_t offset, std::size_t count) {
  std::uint32_t number = 0;
  for (const std::uint8_t byte : bytes.subspan(offset, count)) number = number << 8 | byte;
  return number;
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

std::optional<cv::Size> declared_size(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 8> png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::array<std::uint8_t, 2> jpeg = {0xff, 0xd8};
  const auto starts_with = [&](const auto& magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (starts_with(png)) return size_of_png(bytes);
  if (starts_with(jpeg)) return size_of_jpeg(bytes);
  return std::nullopt;
}

}  // namespace diminish
