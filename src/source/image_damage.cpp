#include "source/image_damage.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "source/image_header.h"

namespace diminish {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr const char* cut_short = "the file is cut short";

/// Whether the end-of-image marker is missing. Neither marker can occur inside of coded pixels.
bool is_jpeg_cut_short(Bytes bytes) {
  constexpr std::array<std::uint8_t, 2> scan_start = {0xff, 0xda};
  constexpr std::array<std::uint8_t, 2> image_end = {0xff, 0xd9};
  const auto last = [&](const std::array<std::uint8_t, 2>& marker) {
    return std::find_end(bytes.begin(), bytes.end(), marker.begin(), marker.end());
  };
  return last(image_end) == bytes.end() || last(image_end) < last(scan_start);
}

/// Checks each chunk's checksum: PNG (ISO/IEC 15948) 5.3.
const char* damage_of_png(Bytes bytes) {
  constexpr std::size_t signature = 8;
  constexpr std::size_t type = 4;
  constexpr std::size_t around = 12;  // length, type and checksum
  std::size_t at = signature;
  while (at + around <= bytes.size()) {
    const std::size_t length = big_endian(bytes.subspan(at, 4));
    if (length > bytes.size() - at - around) return cut_short;
    const Bytes checked = bytes.subspan(at + 4, type + length);
    const std::uint32_t stored = big_endian(bytes.subspan(at + 8 + length, 4));
    if (libdeflate_crc32(0, checked.data(), checked.size()) != stored) return "the file is damaged";
    constexpr std::array<std::uint8_t, type> end = {'I', 'E', 'N', 'D'};
    if (std::equal(end.begin(), end.end(), checked.begin())) return nullptr;
    at += around + length;
  }
  return cut_short;
}

}  // namespace

const char* damage_of(std::span<const std::uint8_t> bytes) {
  if (is_png(bytes)) return damage_of_png(bytes);
  if (bytes.size() < least_bytes(bytes)) return cut_short;
  return is_jpeg(bytes) && is_jpeg_cut_short(bytes) ? cut_short : nullptr;
}

}  // namespace diminish
