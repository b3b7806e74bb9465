#include <vector>

#include "core/channels.h"
#include "core/neighbours.h"
#include "diminish/inpainter.h"
#include "membrane/laplace_solver.h"

namespace diminish {
namespace {

using Channels = LaplaceSolver::Channels;

constexpr float tolerance_levels = 0.1F;

/// The plain version of HarmonicInpainting (harmonic_inpainting.cpp), solved by LaplaceSolver.
class HarmonicReference : public Inpainter {
 public:
  bool inpaint(const Holes& holes, const Options&, Image<Bgr>& picture) override {
    const Mask& missing = holes.missing;
    const Rect box = bounding_box(missing);
    if (box.empty()) return true;
    const auto for_each_pixel = [&](auto&& visit) {
      for (int y = box.y; y < box.bottom(); ++y) {
        for (int x = box.x; x < box.right(); ++x) {
          if (missing(x, y) != 0) visit(x, y, solver_.index(x - box.x, y - box.y));
        }
      }
    };
    solver_.begin(box.width, box.height);
    for_each_pixel([&](int x, int y, int) { solver_.add(x - box.x, y - box.y); });
    solver_.connect();
    bool anything_known = false;
    for_each_pixel([&](int x, int y, int index) {
      for (const auto& [dx, dy] : neighbour_offsets) {
        if (!picture.bounds().contains(x + dx, y + dy) || missing(x + dx, y + dy) != 0) continue;
        solver_.add_anchor(index, 1, to_channels(picture(x + dx, y + dy)));
        anything_known = true;
      }
    });
    if (!anything_known) {
      for_each_pixel([&](int x, int y, int) { picture(x, y) = {}; });
      return false;
    }
    const std::vector<Channels>& filling = solver_.solve(tolerance_levels);
    for_each_pixel([&](int x, int y, int index) {
      picture(x, y) = to_color(filling[static_cast<std::size_t>(index)]);
    });
    return true;
  }

 private:
  LaplaceSolver solver_;
};

const bool registered = Registry<Inpainter>::add(
    "harmonic_reference", [] { return std::make_unique<HarmonicReference>(); });

}  // namespace
}  // namespace diminish
