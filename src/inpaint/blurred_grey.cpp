#include "inpaint/blurred_grey.h"

#include <algorithm>

namespace diminish {
namespace {

constexpr int tile = 32;
constexpr int radius = 2;  ///< of the blur, by 1 4 6 4 1

}  // namespace

void BlurredGrey::begin(const Image<Bgr>& picture, const Rect& part) {
  picture_ = &picture;
  part_ = part;
  levels_.resize(part.width, part.height);
  is_blurred_.resize((part.width + tile - 1) / tile, (part.height + tile - 1) / tile, 0);
}

void BlurredGrey::look_at(const Rect& pixels) {
  const Rect inside = intersect(pixels, levels_.bounds());
  if (inside.empty()) return;
  for (int row = inside.y / tile; row <= (inside.bottom() - 1) / tile; ++row) {
    for (int column = inside.x / tile; column <= (inside.right() - 1) / tile; ++column) {
      if (is_blurred_(column, row) != 0) continue;
      is_blurred_(column, row) = 1;
      blur(intersect({column * tile, row * tile, tile, tile}, levels_.bounds()));
    }
  }
}

void BlurredGrey::blur(const Rect& pixels) {
  std::uint8_t greys[tile + 2 * radius];
  std::uint16_t rows[tile + 2 * radius][tile];
  const int first = std::max(pixels.x - radius, 0);
  const int last = std::min(pixels.right() + radius, part_.width) - 1;
  const auto grey = [&](int x) { return greys + (x - pixels.x + radius); };
  for (int k = 0; k < pixels.height + 2 * radius; ++k) {
    const int y = std::clamp(pixels.y - radius + k, 0, part_.height - 1);
    const Bgr* const colors = picture_->row(part_.y + y) + part_.x;
    for (int x = first; x <= last; ++x) {
      *grey(x) = static_cast<std::uint8_t>(
          (29 * colors[x].b + 150 * colors[x].g + 77 * colors[x].r + 128) >> 8);
    }
    std::fill(grey(pixels.x - radius), grey(first), *grey(first));
    std::fill(grey(last + 1), grey(pixels.right() + radius), *grey(last));
    const std::uint8_t* const from = greys + radius;
    for (int x = 0; x < pixels.width; ++x) {
      rows[k][x] = static_cast<std::uint16_t>(from[x - 2] + from[x + 2] +
                                              4 * (from[x - 1] + from[x + 1]) + 6 * from[x]);
    }
  }
  for (int y = 0; y < pixels.height; ++y) {
    const auto* const from = rows + y;
    std::uint16_t* const out = levels_.row(pixels.y + y) + pixels.x;
    for (int x = 0; x < pixels.width; ++x) {
      out[x] = static_cast<std::uint16_t>(from[0][x] + from[4][x] + 4 * (from[1][x] + from[3][x]) +
                                          6 * from[2][x]);
    }
  }
}

}  // namespace diminish
