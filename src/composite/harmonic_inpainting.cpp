#include <array>
#include <cmath>
#include <vector>

#include "composite/laplace_solver.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

using Channels = LaplaceSolver::Channels;

constexpr float tolerance_levels = 0.1F;

/// The smoothest filling: Laplace's equation with the known neighbours as Dirichlet boundary. It
/// has the least squared gradient of all fillings; it invents no edges.
class HarmonicInpainting : public Inpainter {
 public:
  bool inpaint(const Mask& missing, const Options&, Image<Bgr>& picture) override {
    const Rect holes = bounding_box(missing);
    if (holes.empty()) return true;
    const auto for_each_pixel = [&](auto&& visit) {
      for (int y = holes.y; y < holes.bottom(); ++y) {
        for (int x = holes.x; x < holes.right(); ++x) {
          if (missing(x, y) != 0) visit(x, y, solver_.index(x - holes.x, y - holes.y));
        }
      }
    };
    solver_.begin(holes.width, holes.height);
    for_each_pixel([&](int x, int y, int) { solver_.add(x - holes.x, y - holes.y); });
    solver_.connect();
    bool anything_known = false;
    for_each_pixel([&](int x, int y, int index) {
      constexpr std::array<std::array<int, 2>, 4> steps = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
      for (const auto& [dx, dy] : steps) {
        if (!picture.bounds().contains(x + dx, y + dy) || missing(x + dx, y + dy) != 0) continue;
        const Bgr& known = picture(x + dx, y + dy);
        solver_.add_anchor(index, 1, Channels(known.b, known.g, known.r));
        anything_known = true;
      }
    });
    if (!anything_known) {
      for_each_pixel([&](int x, int y, int) { picture(x, y) = {}; });
      return false;
    }
    const std::vector<Channels>& filling = solver_.solve(tolerance_levels);
    for_each_pixel([&](int x, int y, int index) {
      const Channels& value = filling[static_cast<std::size_t>(index)];
      const auto level = [&](int channel) {
        return static_cast<std::uint8_t>(std::lrint(std::clamp(value[channel], 0.F, 255.F)));
      };
      picture(x, y) = {level(0), level(1), level(2)};
    });
    return true;
  }

 private:
  LaplaceSolver solver_;
};

const bool registered =
    Registry<Inpainter>::add("harmonic", [] { return std::make_unique<HarmonicInpainting>(); });

}  // namespace
}  // namespace diminish
