#pragma once

#include <cstdint>
#include <optional>

#include "diminish/image.h"

namespace diminish {

/// Draws a time into a picture's upper left corner: 32 bits and 8 that check them, a black or white
/// square each, so large that compression leaves them readable. For measuring latency through
/// everything that a picture passes. The picture must be at least 320x8.
/// ticks: tenths of milliseconds.
void draw_clock_code(std::uint32_t ticks, Image<Bgr>& picture);

/// Reads it; nothing if there is none.
std::optional<std::uint32_t> read_clock_code(ImageView<Bgr> picture);

/// A time on the monotonic clock in tenths of milliseconds; begins anew every five days.
inline std::uint32_t clock_ticks(double seconds) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(seconds * 1e4));
}

}  // namespace diminish
