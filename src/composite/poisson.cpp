#include <array>
#include <vector>

#include "composite/channels.h"
#include "composite/laplace_solver.h"
#include "diminish/color_corrector.h"

namespace diminish {
namespace {

using Channels = LaplaceSolver::Channels;

constexpr float tolerance_levels = 0.02F;
/// How strongly parts of the reconstruction that meet the camera's picture nowhere are held to the
/// mean correction. Small, so that seams inside them are evened out first.
constexpr float weak = 1e-3F;

Channels channels(const Bgra& color) {
  return to_channels({color.b, color.g, color.r});
}

struct Offset {
  int x, y;
};
constexpr std::array<Offset, 4> neighbour_offsets = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

/// Poisson seamless cloning (Perez, Gangnet & Blake 2003) of the reconstruction into the camera's
/// picture, in terms of the correction x = result - reconstruction, which is smooth.
///
/// Boundary values (Dirichlet) come only from pixels outside the objects' mask that were also
/// reconstructed: there the correction is camera - reconstruction. Borders to missing pixels and to
/// the picture's edge are free (Neumann). Across the seam between two RGB-D cameras the
/// reconstruction's gradient says nothing; the result's gradient there is zero.
class PoissonCorrection : public ColorCorrector {
 public:
  void correct(const Image<Bgr>& camera, const Mask& occlusion,
               const Reconstruction& reconstruction, Image<Bgr>& picture) override {
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
      for (const Offset& offset : neighbour_offsets) {
        const int nx = x + offset.x;
        const int ny = y + offset.y;
        if (!region.contains(nx, ny) || reconstruction.color(nx, ny).a == 0) continue;
        const bool seam = reconstruction.source(nx, ny) != reconstruction.source(x, y);
        const Channels other = channels(reconstruction.color(nx, ny));
        if (occlusion(nx, ny) != 0) {
          if (seam) solver_.add_source(index, other - own);
        } else {
          const Channels difference = to_channels(camera(nx, ny)) - (seam ? own : other);
          solver_.add_anchor(index, 1, difference);
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
    hold_loose_parts(mean);

    const std::vector<Channels>& correction = solver_.solve(tolerance_levels);
    for_each_pixel([&](int x, int y, int index) {
      picture(x, y) = to_color(channels(reconstruction.color(x, y)) +
                               correction[static_cast<std::size_t>(index)]);
    });
  }

 private:
  /// Anchors the connected parts that have no boundary value.
  void hold_loose_parts(const Channels& mean) {
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
      for (const int index : part_) solver_.add_anchor(index, weak, mean);
    }
  }

  LaplaceSolver solver_;
  std::vector<bool> anchored_, visited_;
  std::vector<int> part_;
};

const bool registered =
    Registry<ColorCorrector>::add("poisson", [] { return std::make_unique<PoissonCorrection>(); });

}  // namespace
}  // namespace diminish
