#include "detect/difference/geodesic_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace diminish {
namespace {

/// There and back, twice: longer ways do not turn more often.
constexpr int sweeps = 4;

/// Where the picture shows something that no RGB-D camera sees, smaller steps between neighbouring
/// pixels are noise or shading, and the way itself is short.
constexpr float noise = 4;
constexpr float shorter = 0.25F;

/// Further away, a pixel stays as it is. In levels, or pixels.
constexpr float longest_way = 30;

/// The least that a step costs.
float least_step(float length, bool is_unlike) {
  return is_unlike ? shorter * length : length;
}

float step(const Bgr& a, const Bgr& b, float length, bool is_unlike) {
  const int blue = a.b - b.b;
  const int green = a.g - b.g;
  const int red = a.r - b.r;
  const float change = std::sqrt(static_cast<float>(blue * blue + green * green + red * red));
  return least_step(length, is_unlike) + (is_unlike ? std::max(0.F, change - noise) : change);
}

bool is_certain(Shown what) {
  return what == Shown::scene || is_object(what);
}

}  // namespace

void GeodesicFill::fill(const Image<Bgr>& picture, const Rect& part, Image<Shown>& shown) {
  part_ = part;
  pixels_.clear();
  // Nothing is reached from beyond the part.
  way_.resize(part.width + 2, part.height + 2, std::numeric_limits<float>::infinity());
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) {
      if (is_certain(shown(x, y))) {
        way_to(x, y) = 0;
        continue;
      }
      pixels_.push_back({x, y, shown(x, y) == Shown::unlike});
    }
  }
  for (int i = 0; i < sweeps; ++i) {
    if (i % 2 == 0) {
      for (const Pixel& pixel : pixels_) improve(picture, pixel, 1, shown);
    } else {
      std::for_each(pixels_.rbegin(), pixels_.rend(),
                    [&](const Pixel& pixel) { improve(picture, pixel, -1, shown); });
    }
  }
  for (const Pixel& pixel : pixels_) {
    if (way_to(pixel.x, pixel.y) > longest_way) shown(pixel.x, pixel.y) = Shown::unknown;
  }
}

/// By its neighbours on the left and above, or on the right and below.
void GeodesicFill::improve(const Image<Bgr>& picture, const Pixel& pixel, int sign,
                           Image<Shown>& shown) {
  constexpr float diagonal = 1.41421356F;
  struct Neighbour {
    int dx, dy;
    float length;
  };
  constexpr std::array<Neighbour, 4> before = {
      {{-1, 0, 1}, {-1, -1, diagonal}, {0, -1, 1}, {1, -1, diagonal}}};
  const auto& [x, y, is_unlike] = pixel;
  float* const place = &way_to(x, y);
  float own = *place;
  for (const auto& [dx, dy, length] : before) {
    const float there = place[sign * (dx + std::ptrdiff_t{dy} * way_.width())];
    if (!(there + least_step(length, is_unlike) < own)) continue;
    const int from_x = x + sign * dx;
    const int from_y = y + sign * dy;
    const float way = there + step(picture(x, y), picture(from_x, from_y), length, is_unlike);
    if (!(way < own)) continue;
    own = way;
    shown(x, y) = shown(from_x, from_y);
  }
  *place = own;
}

}  // namespace diminish
