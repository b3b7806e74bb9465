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

float step(const Bgr& a, const Bgr& b, float length, bool is_unlike) {
  const int blue = a.b - b.b;
  const int green = a.g - b.g;
  const int red = a.r - b.r;
  const float change = std::sqrt(static_cast<float>(blue * blue + green * green + red * red));
  return is_unlike ? shorter * length + std::max(0.F, change - noise) : length + change;
}

bool is_certain(Shown what) {
  return what == Shown::scene || is_object(what);
}

}  // namespace

void GeodesicFill::fill(const Image<Bgr>& picture, const Rect& part, Image<Shown>& shown) {
  part_ = part;
  pixels_.clear();
  way_.resize(picture.width(), picture.height());
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) {
      way_(x, y) = 0;
      if (is_certain(shown(x, y))) continue;
      way_(x, y) = std::numeric_limits<float>::infinity();
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
    if (way_(pixel.x, pixel.y) > longest_way) shown(pixel.x, pixel.y) = Shown::unknown;
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
  float& own = way_(x, y);
  for (const auto& [dx, dy, length] : before) {
    const int from_x = x + sign * dx;
    const int from_y = y + sign * dy;
    if (!part_.contains(from_x, from_y) || !(way_(from_x, from_y) < own)) continue;
    const float way =
        way_(from_x, from_y) + step(picture(x, y), picture(from_x, from_y), length, is_unlike);
    if (!(way < own)) continue;
    own = way;
    shown(x, y) = shown(from_x, from_y);
  }
}

}  // namespace diminish
