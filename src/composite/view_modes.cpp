#include <algorithm>
#include <cmath>

#include "composite/view_mode_rules.h"
#include "core/channels.h"
#include "core/neighbours.h"
#include "core/quick_brightness.h"
#include "core/rows.h"
#include "diminish/view_mode.h"

namespace diminish {
namespace {

/// Sets each pixel of the mask to color(x, y).
template <class Color>
void replace_in_mask(DiminishedFrame& result, const Color& color) {
  for_rows(result.mask.height(), [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* mask = result.mask.row(y);
      Bgr* picture = result.picture.row(y);
      for (int x = 0; x < result.mask.width(); ++x) {
        if (mask[x] != 0) picture[x] = color(x, y);
      }
    }
  });
}

Bgr blend(const Bgr& a, const Bgr& b, float share_of_b) {
  return to_color((1 - share_of_b) * to_channels(a) + share_of_b * to_channels(b));
}

class Remove : public ViewMode {
 public:
  void show(ImageView<Bgr>, const Options&, DiminishedFrame&) const override {}
};

/// The object as if made of glass.
class Half : public ViewMode {
 public:
  void show(ImageView<Bgr> camera, const Options& options, DiminishedFrame& result) const override {
    const auto opacity = static_cast<float>(1 - options.transparency);
    replace_in_mask(
        result, [&](int x, int y) { return blend(result.picture(x, y), camera(x, y), opacity); });
  }
};

/// The background, with the object's edges on top.
class XRay : public ViewMode {
 public:
  void show(ImageView<Bgr> camera, const Options&, DiminishedFrame& result) const override {
    const auto brightness = [&](int x, int y) {
      const Bgr& color =
          camera(std::clamp(x, 0, camera.width() - 1), std::clamp(y, 0, camera.height() - 1));
      return static_cast<float>(quick_brightness(color)) / 4;
    };
    replace_in_mask(result, [&](int x, int y) {
      const float across = brightness(x + 1, y) - brightness(x - 1, y);
      const float down = brightness(x, y + 1) - brightness(x, y - 1);
      const float strength = std::min(1.F, std::hypot(across, down) / xray::full_difference);
      return blend(result.picture(x, y), xray::line_color,
                   strength < xray::least_strength ? 0.F : xray::opacity * strength);
    });
  }
};

/// The background, with a line where the object is.
class Outline : public ViewMode {
 public:
  void show(ImageView<Bgr>, const Options&, DiminishedFrame& result) const override {
    const auto is_beside_mask = [&](int x, int y) {
      const Rect bounds = result.mask.bounds();
      for (const auto& [dx, dy] : neighbour_offsets) {
        for (int i = 1; i <= outline::width_px; ++i) {
          const int px = x + i * dx;
          const int py = y + i * dy;
          if (bounds.contains(px, py) && result.mask(px, py) == 0) return true;
        }
      }
      return false;
    };
    replace_in_mask(result, [&](int x, int y) {
      return is_beside_mask(x, y) ? outline::line_color : result.picture(x, y);
    });
  }
};

/// Shows what was seen in green and what was invented in magenta, hatched.
class Provenance : public ViewMode {
 public:
  void show(ImageView<Bgr>, const Options&, DiminishedFrame& result) const override {
    using namespace provenance_view;
    replace_in_mask(result, [&](int x, int y) -> Bgr {
      const Bgr& color = result.picture(x, y);
      const std::uint8_t origin = result.provenance(x, y);
      if (origin < provenance::inpainted) return blend(color, color_of(origin), tint);
      const bool is_line = (x + y) % period_px < line_px;
      return is_line ? invented_color : blend(color, invented_color, tint);
    });
  }

 private:
  static Bgr color_of(std::uint8_t origin) {
    using namespace provenance_view;
    return origin == provenance::witnessed    ? witnessed_color
           : origin == provenance::remembered ? remembered_color
           : origin == provenance::estimated  ? estimated_color
                                              : seen_color;
  }
};

template <class Mode>
bool add(const char* name) {
  return Registry<ViewMode>::add(name, [] { return std::make_unique<Mode>(); });
}
const bool view_modes_registered = add<Remove>("remove") && add<Half>("half") &&
                                   add<XRay>("xray") && add<Outline>("outline") &&
                                   add<Provenance>("provenance");

}  // namespace
}  // namespace diminish
