#include "detect/color_blob/outline_refinement.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/extremum_filters.h"

namespace diminish {
namespace {

using Labels = WatershedLabel<std::uint8_t>;
constexpr std::uint8_t object_label = 1;
constexpr std::uint8_t background_label = 2;

// How far, in cells, the outline may be inside and outside the region's.
constexpr int inward = 1;
constexpr int outward = 2;
// The border of the area is outside, and a watershed does not label the outermost pixels.
constexpr int rim = outward + 1;

int squared_distance(const Bgr& a, const Bgr& b) {
  const int blue = a.b - b.b;
  const int green = a.g - b.g;
  const int red = a.r - b.r;
  return blue * blue + green * green + red * red;
}

}  // namespace

Rect OutlineRefinement::refine(ImageView<Bgr> image, const Mask& region, const Rect& window,
                               int scale, Mask& object) {
  const Rect box = bounding_box(region);
  if (box.empty()) return {};
  find_band(region, box);
  set_labels(scale);
  const Rect part{(window.x + box.x - rim) * scale, (window.y + box.y - rim) * scale,
                  labels_.width(), labels_.height()};
  smooth_band(image, part, scale);
  watershed_.flood(smooth_, labels_);
  const Rect visible = intersect(part, image.bounds());
  write_object(part, visible, object);
  return visible;
}

/// Fills `cells_`: surely inside, surely outside, or unknown.
void OutlineRefinement::find_band(const Mask& region, const Rect& box) {
  // Beyond the picture's border both continue, so that an object that is cut off there is not
  // closed.
  coarse_.resize(box.width + 2 * rim, box.height + 2 * rim);
  for (int y = 0; y < coarse_.height(); ++y) {
    const std::uint8_t* const row = region.row(std::clamp(box.y + y - rim, 0, region.height() - 1));
    std::uint8_t* const coarse = coarse_.row(y);
    // A local copy: a stored byte could alias the member.
    const int width = coarse_.width();
    const int last = region.width() - 1;
    for (int x = 0; x < width; ++x) coarse[x] = row[std::clamp(box.x + x - rim, 0, last)];
  }
  erode(coarse_, {inward, inward}, scratch_, inside_);
  dilate(coarse_, {outward, outward}, scratch_, not_outside_);
  cells_.resize(coarse_.width(), coarse_.height());
  std::transform(inside_.begin(), inside_.end(), not_outside_.begin(), cells_.begin(),
                 [](std::uint8_t inside, std::uint8_t not_outside) {
                   const std::uint8_t not_inside =
                       not_outside != 0 ? Labels::unknown : background_label;
                   return inside != 0 ? object_label : not_inside;
                 });
}

void OutlineRefinement::set_labels(int scale) {
  labels_.resize(cells_.width() * scale, cells_.height() * scale);
  for (int y = 0; y < labels_.height(); ++y) {
    std::uint8_t* const row = labels_.row(y);
    if (y % scale != 0) {
      std::copy_n(labels_.row(y - 1), labels_.width(), row);
      continue;
    }
    for (int x = 0; x < cells_.width(); ++x) {
      std::fill_n(row + std::ptrdiff_t{x} * scale, scale, cells_(x, y / scale));
    }
  }
}

void OutlineRefinement::smooth_band(ImageView<Bgr> image, const Rect& part, int scale) {
  smooth_.resize(labels_.width(), labels_.height());
  for (int y = 0; y < labels_.height(); ++y) {
    const std::uint8_t* const here = cells_.row(y / scale);
    const std::uint8_t* const above = cells_.row(std::max(y - 1, 0) / scale);
    const std::uint8_t* const below = cells_.row(std::min(y + 1, labels_.height() - 1) / scale);
    const auto is_near = [&](int x) {
      return here[x] == Labels::unknown || above[x] == Labels::unknown ||
             below[x] == Labels::unknown;
    };
    for (int x = 0; x < cells_.width();) {
      if (!is_near(x)) {
        ++x;
        continue;
      }
      const int begin = x;
      while (x < cells_.width() && is_near(x)) ++x;
      const int first = std::max(begin * scale - 1, 0);
      const int last = std::min(x * scale + 1, labels_.width());
      smoother_.smooth_row(image, part, y, first, last, smooth_.row(y) + first);
    }
  }
}

/// The side to which a pixel of the watershed line belongs: that of the neighbour with the most
/// similar colour.
std::uint8_t OutlineRefinement::nearest_side(int pixel) const {
  std::uint8_t side = object_label;
  int smallest = std::numeric_limits<int>::max();
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int neighbor = pixel + dy * labels_.width() + dx;
      const std::uint8_t label = labels_.data()[neighbor];
      if (label != object_label && label != background_label) continue;
      const int distance = squared_distance(smooth_.data()[pixel], smooth_.data()[neighbor]);
      if (distance >= smallest) continue;
      smallest = distance;
      side = label;
    }
  }
  return side;
}

/// Marks the outermost pixels as outside.
void OutlineRefinement::write_object(const Rect& part, const Rect& visible, Mask& object) const {
  object.resize(visible.width, visible.height);
  for (int y = 0; y < visible.height; ++y) {
    const std::uint8_t* const label = labels_.row(visible.y - part.y + y) + (visible.x - part.x);
    std::transform(label, label + visible.width, object.row(y),
                   [](std::uint8_t own) -> std::uint8_t { return own == object_label ? 255 : 0; });
  }
  for (const int pixel : watershed_.line()) {
    const int x = pixel % labels_.width() + part.x - visible.x;
    const int y = pixel / labels_.width() + part.y - visible.y;
    if (!object.bounds().contains(x, y)) continue;
    if (nearest_side(pixel) == object_label) object(x, y) = 255;
  }
}

}  // namespace diminish
