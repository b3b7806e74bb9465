#include "composite/soft_rim.h"

#include <algorithm>

#include "core/rows.h"

namespace diminish {
namespace {

/// Takes away what touches the outside: by an edge, or by a corner, too. The outermost pixels stay.
void erode(const Mask& inside, bool by_corners, Mask& eroded) {
  const int width = inside.width();
  eroded = inside;
  for_rows(inside.height() - 2, [&](Rows rows) {
    for (int y = rows.first + 1; y < rows.last + 1; ++y) {
      const std::uint8_t* above = inside.row(y - 1);
      const std::uint8_t* here = inside.row(y);
      const std::uint8_t* below = inside.row(y + 1);
      std::uint8_t* result = eroded.row(y);
      for (int x = 1; x < width - 1; ++x) {
        result[x] = above[x] & here[x - 1] & here[x] & here[x + 1] & below[x];
      }
      if (!by_corners) continue;
      for (int x = 1; x < width - 1; ++x) {
        result[x] &= above[x - 1] & above[x + 1] & below[x - 1] & below[x + 1];
      }
    }
  });
}

std::uint8_t mix(int from, int to, int part, int whole) {
  return static_cast<std::uint8_t>((from * (whole - part) + to * part + whole / 2) / whole);
}

}  // namespace

void SoftRim::blend(const Image<Bgr>& camera, const Mask& mask, int width_px, Image<Bgr>& picture) {
  const Rect box = bounding_box(mask);
  if (width_px <= 0 || box.empty()) return;
  // Beyond the images' borders is no outside: there the mask is continued.
  const Rect around = grow(box, 1);
  inside_.resize(around.width, around.height);
  for (int y = 0; y < around.height; ++y) {
    const std::uint8_t* row = mask.row(std::clamp(around.y + y, 0, mask.height() - 1));
    for (int x = 0; x < around.width; ++x) {
      inside_(x, y) = row[std::clamp(around.x + x, 0, mask.width() - 1)] != 0 ? 1 : 0;
    }
  }
  distance_ = inside_;
  for (int step = 0; step < width_px; ++step) {
    erode(inside_, step % 2 != 0, eroded_);
    std::swap(inside_, eroded_);
    std::transform(distance_.begin(), distance_.end(), inside_.begin(), distance_.begin(),
                   [](std::uint8_t d, std::uint8_t further) {
                     return static_cast<std::uint8_t>(d + further);
                   });
  }
  const int whole = width_px + 1;
  for_rows(box.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* distance = distance_.row(y + 1) + 1;
      const Bgr* from = camera.row(box.y + y) + box.x;
      Bgr* to = picture.row(box.y + y) + box.x;
      for (int x = 0; x < box.width; ++x) {
        const int d = distance[x];
        if (d == 0 || d == whole) continue;
        to[x] = {mix(from[x].b, to[x].b, d, whole), mix(from[x].g, to[x].g, d, whole),
                 mix(from[x].r, to[x].r, d, whole)};
      }
    }
  });
}

}  // namespace diminish
