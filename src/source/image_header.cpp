#include "source/image_header.h"

#include <algorithm>
#include <array>
#include <cctype>
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

/// Of bytes that are there, the least significant first.
std::uint32_t little_endian(Bytes bytes) {
  std::uint32_t number = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) number = number << 8 | bytes[i - 1];
  return number;
}

/// Uncompressed ones; the others are hardly ever written.
std::optional<cv::Size> size_of_bmp(Bytes bytes) {
  constexpr std::size_t compression_at = 30;
  constexpr std::uint32_t as_bit_fields = 3;
  if (bytes.size() < compression_at + 4) return std::nullopt;
  const std::uint32_t compression = little_endian(bytes.subspan(compression_at, 4));
  if (compression != 0 && compression != as_bit_fields) return std::nullopt;
  const std::uint32_t height = little_endian(bytes.subspan(22, 4));
  // Negative: from the top down.
  const bool is_negative = height >> 31 != 0;
  return size_of(little_endian(bytes.subspan(18, 4)), is_negative ? 0U - height : height);
}

/// Of its first directory.
std::optional<cv::Size> size_of_tiff(Bytes bytes) {
  const bool is_little = bytes[0] == 'I';
  const auto number = [&](std::size_t at, std::size_t count) -> std::uint32_t {
    if (at > bytes.size() || count > bytes.size() - at) return 0;
    const Bytes part = bytes.subspan(at, count);
    return is_little ? little_endian(part) : big_endian(part);
  };
  constexpr std::uint32_t width_tag = 256;
  constexpr std::uint32_t height_tag = 257;
  constexpr std::uint32_t of_16_bits = 3;
  constexpr std::size_t entry_size = 12;
  const std::size_t directory = number(4, 4);
  const std::uint32_t count = number(directory, 2);
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t entry = directory + 2 + i * entry_size;
    const std::uint32_t tag = number(entry, 2);
    const std::uint32_t value = number(entry + 8, number(entry + 2, 2) == of_16_bits ? 2 : 4);
    // Whichever counts of several.
    if (tag == width_tag) width = std::max(width, value);
    if (tag == height_tag) height = std::max(height, value);
  }
  return size_of(width, height);
}

/// Lossy (VP8), lossless (VP8L) or with a canvas (VP8X): its first chunk tells.
std::optional<cv::Size> size_of_webp(Bytes bytes) {
  constexpr std::size_t whole_header = 30;
  if (bytes.size() < whole_header) return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t count) {
    return little_endian(bytes.subspan(at, count));
  };
  constexpr std::uint32_t fourteen_bits = (1 << 14) - 1;
  switch (bytes[15]) {
    case ' ':
      return size_of(number(26, 2) & fourteen_bits, number(28, 2) & fourteen_bits);
    case 'L':
      return size_of((number(21, 4) & fourteen_bits) + 1,
                     (number(21, 4) >> 14 & fourteen_bits) + 1);
    case 'X':
      return size_of(number(24, 3) + 1, number(27, 3) + 1);
    default:
      return std::nullopt;
  }
}

std::size_t end_of_line(Bytes bytes, std::size_t at) {
  while (at < bytes.size() && bytes[at] != '\n') ++at;
  return at;
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

std::optional<PnmHeader> pnm_header(std::span<const std::uint8_t> bytes) {
  const bool is_grey = starts_with<2>(bytes, {'P', '5'});
  if (!is_grey && !starts_with<2>(bytes, {'P', '6'})) return std::nullopt;
  const auto is_space = [&](std::size_t i) {
    return i < bytes.size() && std::isspace(bytes[i]) != 0;
  };
  std::array<std::uint32_t, 3> numbers = {};  // width, height, the largest value
  std::size_t at = 2;
  for (std::uint32_t& number : numbers) {
    if (!is_space(at)) return std::nullopt;
    while (is_space(at) || (at < bytes.size() && bytes[at] == '#')) {
      if (bytes[at] == '#') at = end_of_line(bytes, at);
      ++at;
    }
    constexpr std::uint32_t most = 100'000'000;
    for (; at < bytes.size() && std::isdigit(bytes[at]) != 0; ++at) {
      number = std::min(most, 10 * number + (bytes[at] - std::uint32_t{'0'}));
    }
  }
  const auto [width, height, largest] = numbers;
  constexpr std::uint32_t largest_of_a_byte = 255;
  if (largest == 0 || !is_space(at)) return std::nullopt;
  const std::size_t channels = is_grey ? 1 : 3;
  return PnmHeader{width, height, channels * (largest > largest_of_a_byte ? 2 : 1), at + 1};
}

std::optional<cv::Size> declared_size(std::span<const std::uint8_t> bytes) {
  if (is_png(bytes)) return size_of_png(bytes);
  if (is_jpeg(bytes)) return size_of_jpeg(bytes);
  if (starts_with<2>(bytes, {'B', 'M'})) return size_of_bmp(bytes);
  if (starts_with<4>(bytes, {'I', 'I', 42, 0}) || starts_with<4>(bytes, {'M', 'M', 0, 42})) {
    return size_of_tiff(bytes);
  }
  if (starts_with<4>(bytes, {'R', 'I', 'F', 'F'})) return size_of_webp(bytes);
  const auto pnm = pnm_header(bytes);
  return pnm ? size_of(pnm->width, pnm->height) : std::nullopt;
}

std::size_t least_bytes(std::span<const std::uint8_t> bytes) {
  if (const auto pnm = pnm_header(bytes)) {
    return pnm->pixels_at + std::size_t{pnm->width} * pnm->height * pnm->bytes_a_pixel;
  }
  const bool is_bmp = starts_with<2>(bytes, {'B', 'M'});
  const auto size = is_bmp ? size_of_bmp(bytes) : std::nullopt;
  if (!size) return 0;
  const std::size_t bits =
      static_cast<std::size_t>(size->width) * little_endian(bytes.subspan(28, 2));
  return little_endian(bytes.subspan(10, 4)) +
         (bits + 31) / 32 * 4 * static_cast<std::size_t>(size->height);
}

}  // namespace diminish
