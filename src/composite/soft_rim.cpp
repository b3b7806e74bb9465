#include "composite/soft_rim.h"

#include <algorithm>

#include "core/rows.h"
#include "core/runs.h"

namespace diminish {
namespace {

/// Removes pixels that touch the outside, by an edge or also by a corner. The outermost pixels
/// stay.
void erode_row(const Mask& inside, int y, bool by_corners, std::uint8_t* result) {
  const int width = inside.width();
  const std::uint8_t* here = inside.row(y);
  if (y == 0 || y == inside.height() - 1) {
    std::copy_n(here, width, result);
    return;
  }
  const std::uint8_t* above = inside.row(y - 1);
  const std::uint8_t* below = inside.row(y + 1);
  result[0] = here[0];
  result[width - 1] = here[width - 1];
  if (by_corners) {
    for (int x = 1; x < width - 1; ++x) {
      result[x] = above[x - 1] & above[x] & above[x + 1] & here[x - 1] & here[x] & here[x + 1] &
                  below[x - 1] & below[x] & below[x + 1];
    }
  } else {
    for (int x = 1; x < width - 1; ++x) {
      result[x] = above[x] & here[x - 1] & here[x] & here[x + 1] & below[x];
    }
  }
}

std::uint8_t mix(int from, int to, int part, int whole) {
  return static_cast<std::uint8_t>((from * (whole - part) + to * part + whole / 2) / whole);
}

/// Calls visit(x) for each distance that is neither 0 nor `whole`.
template <class Visit>
void for_each_between(const std::uint8_t* distances, int width, std::uint8_t whole,
                      const Visit& visit) {
  // Most pixels are far from the rim.
  constexpr int step = 32;
  for (int first = 0; first < width; first += step) {
    const int end = std::min(first + step, width);
    if (first + step <= width &&
        (all_equal<step>(distances + first, 0) || all_equal<step>(distances + first, whole))) {
      continue;
    }
    for (int x = first; x < end; ++x) {
      if (distances[x] != 0 && distances[x] != whole) visit(x);
    }
  }
}

}  // namespace

/// Beyond the image's border the mask continues, so nothing there is outside.
/// around: some rows of the box and one pixel more on each side.
void SoftRim::find_distances(const Mask& mask, const Rect& around, const Rect& box, int width_px,
                             Scratch& scratch) {
  auto& [distances, inside, eroded] = scratch;
  inside.resize(around.width, around.height);
  distances.resize(around.width, around.height);
  eroded.resize(around.width, around.height);
  for (int y = 0; y < around.height; ++y) {
    const std::uint8_t* from = mask.row(std::clamp(around.y + y, 0, mask.height() - 1)) + box.x;
    std::uint8_t* to = inside.row(y) + 1;
    // A local copy: a stored byte could alias a reference.
    const int width = box.width;
    for (int x = 0; x < width; ++x) to[x] = from[x] != 0 ? 1 : 0;
    to[-1] = box.x > 0 ? 0 : to[0];
    to[box.width] = box.right() < mask.width() ? 0 : to[box.width - 1];
    std::copy_n(inside.row(y), around.width, distances.row(y));
  }
  for (int step = 0; step < width_px; ++step) {
    for (int y = 0; y < around.height; ++y) {
      erode_row(inside, y, step % 2 != 0, eroded.row(y));
      std::uint8_t* distance = distances.row(y);
      const std::uint8_t* further = eroded.row(y);
      const int width = around.width;
      for (int x = 0; x < width; ++x) {
        distance[x] = static_cast<std::uint8_t>(distance[x] + further[x]);
      }
    }
    std::swap(inside, eroded);
  }
}

void SoftRim::blend(ImageView<Bgr> camera, const Mask& mask, const Rect& box, int width_px,
                    Image<Bgr>& picture) {
  if (width_px <= 0 || box.empty()) return;
  const auto whole = static_cast<std::uint8_t>(width_px + 1);
  const Rect all = grow(box, 1);
  for_rows(box.height, [&](Rows rows) {
    Scratch& scratch = scratch_[rows.band];
    const Rect band{all.x, box.y + rows.first, all.width, rows.last - rows.first};
    const Rect around = intersect(grow(band, width_px), all);
    find_distances(mask, around, box, width_px, scratch);
    for (int y = band.y; y < band.bottom(); ++y) {
      const std::uint8_t* distance = scratch.distance.row(y - around.y) + 1;
      const Bgr* from = camera.row(y) + box.x;
      Bgr* to = picture.row(y) + box.x;
      for_each_between(distance, box.width, whole, [&](int x) {
        const int d = distance[x];
        to[x] = {mix(from[x].b, to[x].b, d, whole), mix(from[x].g, to[x].g, d, whole),
                 mix(from[x].r, to[x].r, d, whole)};
      });
    }
  });
}

}  // namespace diminish
