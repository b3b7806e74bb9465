#include <atomic>
#include <bit>
#include <cstddef>

#include "composite/membrane_methods.h"
#include "core/channels.h"
#include "core/neighbours.h"
#include "core/rows.h"
#include "diminish/color_corrector.h"
#include "membrane/picture.h"
#include "membrane/solver.h"

namespace diminish {
namespace {

/// Of the last multigrid correction; what is left of the error is smaller.
constexpr float tolerance_levels = 0.5F;
struct Difference {
  float value[MembraneSolver::channels];

  Difference(const Bgr& a, const Bgra& b)
      : value{static_cast<float>(a.b - b.b), static_cast<float>(a.g - b.g),
              static_cast<float>(a.r - b.r)} {}
};

/// Poisson seamless cloning (Perez, Gangnet & Blake 2003) of the reconstruction into the camera's
/// picture, in terms of the correction x = result - reconstruction, which is smooth.
///
/// Boundary values (Dirichlet) come only from pixels outside the objects' mask that were also
/// reconstructed: there the correction is camera - reconstruction. Borders to missing pixels and to
/// the picture's edge are free (Neumann). Across the seam between two RGB-D cameras the
/// reconstruction's gradient says nothing; the result's gradient there is zero. Parts without any
/// boundary value get the mean correction.
class PoissonCorrection : public ColorCorrector {
 public:
  explicit PoissonCorrection(std::unique_ptr<MembraneSolver> solver) : solver_(std::move(solver)) {}

  Declaration declaration() const override { return {.simpler = "affine"}; }

  void correct(const ColorInputs& inputs, Image<Bgr>& picture) override {
    const auto& [camera, occlusion, reconstruction, maps] = inputs;
    const Rect objects = bounding_box(occlusion, reconstruction.region);
    const Rect region = intersect(grow(objects, 1), reconstruction.region);
    if (region.empty()) return;
    solver_->begin(region.width, region.height);
    std::atomic<unsigned> sources = 0;
    for_rows(region.height, [&](Rows rows) {
      unsigned found = 0;
      for (int row = rows.first; row < rows.last; ++row) {
        const std::uint8_t* mask = occlusion.row(region.y + row) + region.x;
        const std::uint8_t* source = reconstruction.source.row(region.y + row) + region.x;
        std::uint8_t* keys = solver_->keys(row);
        for (int i = 0; i < region.width; ++i) {
          const std::uint8_t outside = source[i] != 0 ? MembraneSolver::fixed : 0;
          keys[i] = mask[i] != 0 ? source[i] : outside;
          found |= mask[i] != 0 ? source[i] : 0U;
        }
      }
      sources |= found;
    });
    solver_->connect();
    if (solver_->size() == 0) return;

    double sum[MembraneSolver::channels] = {};
    std::size_t count = 0;
    solver_->for_each_fixed([&](int x, int y) {
      const Difference difference(camera(region.x + x, region.y + y),
                                  reconstruction.color(region.x + x, region.y + y));
      solver_->set_fixed(x, y, difference.value);
      for (int c = 0; c < MembraneSolver::channels; ++c) {
        sum[c] += static_cast<double>(difference.value[c]);
      }
      ++count;
    });
    Eigen::Array3f mean = Eigen::Array3f::Zero();
    for (int c = 0; c < MembraneSolver::channels && count > 0; ++c) {
      mean[c] = static_cast<float>(sum[c] / static_cast<double>(count));
    }
    for (const LooseRun& run : solver_->take_out_loose_parts()) {
      const int y = region.y + run.y;
      for (int x = region.x + run.first; x < region.x + run.last; ++x) {
        const Bgra& color = reconstruction.color(x, y);
        picture(x, y) = to_color(to_channels({color.b, color.g, color.r}) + mean);
      }
    }
    // One camera has no seams.
    const bool has_seams = !std::has_single_bit(sources.load());
    if (has_seams) even_out_seams(reconstruction, region);
    solver_->solve(tolerance_levels);
    add_solution(*solver_, region, reconstruction.color, picture);
  }

 private:
  void even_out_seams(const Reconstruction& reconstruction, const Rect& region) {
    solver_->for_each_irregular([&](int column, int row) {
      const int x = region.x + column;
      const int y = region.y + row;
      for (const auto& [dx, dy] : neighbour_offsets) {
        if (!region.contains(x + dx, y + dy)) continue;
        const std::uint8_t other = reconstruction.source(x + dx, y + dy);
        if (other == 0 || other == reconstruction.source(x, y)) continue;
        const Bgra& color = reconstruction.color(x + dx, y + dy);
        const Difference difference({color.b, color.g, color.r}, reconstruction.color(x, y));
        solver_->add_source(column, row, difference.value);
      }
    });
  }

  std::unique_ptr<MembraneSolver> solver_;
};

const bool registered = Registry<ColorCorrector>::add(
    "poisson", [] { return make_poisson_correction(std::make_unique<MembraneSolver>()); });

}  // namespace

std::unique_ptr<ColorCorrector> make_poisson_correction(std::unique_ptr<MembraneSolver> solver) {
  return std::make_unique<PoissonCorrection>(std::move(solver));
}

}  // namespace diminish
