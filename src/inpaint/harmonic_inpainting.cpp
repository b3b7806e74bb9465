#include "composite/membrane_methods.h"
#include "core/rows.h"
#include "diminish/inpainter.h"
#include "membrane/picture.h"
#include "membrane/solver.h"

namespace diminish {
namespace {

/// Of the last multigrid correction; what is left of the error is smaller.
constexpr float tolerance_levels = 1.F;

/// The smoothest filling: Laplace's equation with the known neighbours as Dirichlet boundary. It
/// has the least squared gradient of all fillings; it invents no edges.
class HarmonicInpainting : public Inpainter {
 public:
  explicit HarmonicInpainting(std::unique_ptr<MembraneSolver> solver)
      : solver_(std::move(solver)) {}

  bool inpaint(const Holes& holes, const Options&, Image<Bgr>& picture) override {
    const Mask& missing = holes.missing;
    const Rect box = bounding_box(missing);
    if (box.empty()) return true;
    const Rect window = intersect(grow(box, 1), picture.bounds());
    solver_->begin(window.width, window.height);
    for_rows(window.height, [&](Rows rows) {
      for (int row = rows.first; row < rows.last; ++row) {
        const std::uint8_t* mask = missing.row(window.y + row) + window.x;
        std::uint8_t* keys = solver_->keys(row);
        for (int i = 0; i < window.width; ++i) keys[i] = mask[i] != 0 ? 1 : MembraneSolver::fixed;
      }
    });
    solver_->connect();
    bool anything_known = false;
    solver_->for_each_fixed([&](int x, int y) {
      const Bgr& color = picture(window.x + x, window.y + y);
      solver_->set_fixed(
          x, y,
          {static_cast<float>(color.b), static_cast<float>(color.g), static_cast<float>(color.r)});
      anything_known = true;
    });
    if (!anything_known) {
      picture.fill(box, {});
      return false;
    }
    solver_->solve(tolerance_levels);
    write_solution(*solver_, window, picture);
    return true;
  }

 private:
  std::unique_ptr<MembraneSolver> solver_;
};

const bool registered = Registry<Inpainter>::add(
    "harmonic", [] { return make_harmonic_inpainting(std::make_unique<MembraneSolver>()); });

}  // namespace

std::unique_ptr<Inpainter> make_harmonic_inpainting(std::unique_ptr<MembraneSolver> solver) {
  return std::make_unique<HarmonicInpainting>(std::move(solver));
}

}  // namespace diminish
