#include <array>
#include <vector>

#include "core/channels.h"
#include "core/neighbours.h"
#include "diminish/color_corrector.h"
#include "membrane/laplace_solver.h"

namespace diminish {
namespace {

using Channels = LaplaceSolver::Channels;

constexpr float tolerance_levels = 0.02F;
Channels channels(const Bgra& color) {
  return to_channels({color.b, color.g, color.r});
}

/// The plain version of PoissonCorrection (poisson.cpp): the same equations, pixel by pixel, solved
/// by LaplaceSolver.
class PoissonReference : public ColorCorrector {
 public:
  Declaration declaration() const override { return {.simpler = "affine"}; }

  void correct(const ColorInputs& inputs, Image<Bgr>& picture) override {
    const auto& [camera, occlusion, reconstruction, maps] = inputs;
    const Rect& region = reconstruction.region;
    const auto valid = [&](int x, int y) {
      return region.contains(x, y) && occlusion(x, y) != 0 && reconstruction.color(x, y).a != 0;
    };
    const auto for_each_pixel = [&](auto&& visit) {
      for (int y = region.y; y < region.bottom(); ++y) {
        for (int x = region.x; x < region.right(); ++x) {
          if (valid(x, y)) visit(x, y, solver_.index(x - region.x, y - region.y));
        }
      }
    };

    solver_.begin(region.width, region.height);
    for_each_pixel([&](int x, int y, int) { solver_.add(x - region.x, y - region.y); });
    solver_.connect();

    anchored_.assign(solver_.size(), false);
    Eigen::Array3d difference_sum = Eigen::Array3d::Zero();
    std::size_t difference_count = 0;
    for_each_pixel([&](int x, int y, int index) {
      const Channels own = channels(reconstruction.color(x, y));
      for (const PixelOffset& offset : neighbour_offsets) {
        const int nx = x + offset.x;
        const int ny = y + offset.y;
        if (!region.contains(nx, ny) || reconstruction.color(nx, ny).a == 0) continue;
        const bool seam = reconstruction.source(nx, ny) != reconstruction.source(x, y);
        const Channels other = channels(reconstruction.color(nx, ny));
        if (occlusion(nx, ny) != 0) {
          if (seam) solver_.add_source(index, other - own);
        } else {
          const Channels difference = to_channels(camera(nx, ny)) - other;
          solver_.add_anchor(index, 1, seam ? difference + other - own : difference);
          anchored_[static_cast<std::size_t>(index)] = true;
          difference_sum += difference.cast<double>();
          ++difference_count;
        }
      }
    });
    Channels mean = Channels::Zero();
    if (difference_count > 0) {
      mean = (difference_sum / static_cast<double>(difference_count)).cast<float>();
    }
    find_loose_parts();

    const std::vector<Channels>& correction = solver_.solve(tolerance_levels);
    for_each_pixel([&](int x, int y, int index) {
      const auto i = static_cast<std::size_t>(index);
      picture(x, y) =
          to_color(channels(reconstruction.color(x, y)) + (loose_[i] ? mean : correction[i]));
    });
  }

 private:
  /// Finds the connected parts that have no boundary value, and anchors them somewhere.
  void find_loose_parts() {
    loose_.assign(solver_.size(), false);
    visited_.assign(solver_.size(), false);
    for (std::size_t start = 0; start < solver_.size(); ++start) {
      if (visited_[start]) continue;
      bool loose = true;
      part_.assign(1, static_cast<int>(start));
      visited_[start] = true;
      for (std::size_t i = 0; i < part_.size(); ++i) {
        loose = loose && !anchored_[static_cast<std::size_t>(part_[i])];
        for (const int neighbour : solver_.neighbours(part_[i])) {
          if (neighbour < 0 || visited_[static_cast<std::size_t>(neighbour)]) continue;
          visited_[static_cast<std::size_t>(neighbour)] = true;
          part_.push_back(neighbour);
        }
      }
      if (!loose) continue;
      solver_.add_anchor(part_.front(), 1, Channels::Zero());
      for (const int index : part_) loose_[static_cast<std::size_t>(index)] = true;
    }
  }

  LaplaceSolver solver_;
  std::vector<bool> anchored_, loose_, visited_;
  std::vector<int> part_;
};

const bool registered = Registry<ColorCorrector>::add(
    "poisson_reference", [] { return std::make_unique<PoissonReference>(); });

}  // namespace
}  // namespace diminish
