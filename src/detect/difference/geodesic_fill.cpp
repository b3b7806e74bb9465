#include "detect/difference/geodesic_fill.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace diminish {
namespace {

/// There and back, twice: longer ways do not turn more often.
constexpr int sweeps = 4;

/// Further away, an unknown pixel stays unknown. In levels, or pixels.
constexpr float longest_way = 30;

/// Where the picture shows something that no RGB-D camera sees, smaller steps between neighbouring
/// pixels are noise or shading, and the way itself is short.
constexpr float noise = 4;
constexpr float shorter = 0.25F;

float step(const Bgr& a, const Bgr& b, float length, bool is_unlike) {
  const int blue = a.b - b.b;
  const int green = a.g - b.g;
  const int red = a.r - b.r;
  const float change = std::sqrt(static_cast<float>(blue * blue + green * green + red * red));
  return is_unlike ? shorter * length + std::max(0.F, change - noise) : length + change;
}

bool is_known(Shown what) {
  return what == Shown::scene || is_object(what);
}

}  // namespace

void GeodesicFill::fill(const Image<Bgr>& picture, const Rect& part, Image<Shown>& shown) {
  distance_.resize(picture.width(), picture.height());
  unlike_.resize(picture.width(), picture.height());
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) {
      unlike_(x, y) = shown(x, y) == Shown::unlike ? 255 : 0;
      distance_(x, y) =
          is_known(shown(x, y)) ? 0.F : std::numeric_limits<float>::infinity();
    }
  }
  for (int i = 0; i < sweeps; ++i) sweep(picture, part, i % 2 == 1, shown);
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) {
      if (distance_(x, y) > longest_way) shown(x, y) = Shown::unknown;
    }
  }
}

void GeodesicFill::sweep(const Image<Bgr>& picture, const Rect& part, bool backward,
                         Image<Shown>& shown) {
  constexpr float diagonal = 1.41421356F;
  struct Neighbour {
    int dx, dy;
    float length;
  };
  constexpr std::array<Neighbour, 4> before = {
      {{-1, 0, 1}, {-1, -1, diagonal}, {0, -1, 1}, {1, -1, diagonal}}};
  const int sign = backward ? -1 : 1;
  for (int row = 0; row < part.height; ++row) {
    const int y = backward ? part.bottom() - 1 - row : part.y + row;
    for (int column = 0; column < part.width; ++column) {
      const int x = backward ? part.right() - 1 - column : part.x + column;
      float& own = distance_(x, y);
      if (own == 0) continue;
      const bool is_unlike = unlike_(x, y) != 0;
      for (const auto& [dx, dy, length] : before) {
        const int from_x = x + sign * dx;
        const int from_y = y + sign * dy;
        if (!part.contains(from_x, from_y)) continue;
        const float way = distance_(from_x, from_y) +
                          step(picture(x, y), picture(from_x, from_y), length, is_unlike);
        if (!(way < own)) continue;
        own = way;
        shown(x, y) = shown(from_x, from_y);
      }
    }
  }
}

}  // namespace diminish
