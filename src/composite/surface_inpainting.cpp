#include <array>

#include "composite/membrane_picture.h"
#include "composite/membrane_solver.h"
#include "core/rows.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

/// Of the last multigrid correction; what is left of the error is smaller.
constexpr float tolerance_levels = 1.F;

/// Fills each plane of the background from its own pixels alone, as smoothly as can be: what stands
/// in front of a wall does not bleed onto it, and where table and wall meet there is an edge. What
/// is left, having no pixel of its plane beside it, is filled from all pixels around.
class SurfaceInpainting : public Inpainter {
 public:
  bool inpaint(const Mask& missing, const Reconstruction& reconstruction, const Options&,
               Image<Bgr>& picture) override {
    const Rect holes = bounding_box(missing);
    if (holes.empty()) return true;
    window_ = intersect(grow(holes, 1), picture.bounds());
    collect_states(missing, reconstruction);
    for (int label = surface_label::first_plane; label < surface_label::foreground; ++label) {
      if (boxes_[static_cast<std::size_t>(label)].empty()) continue;
      fill_plane(static_cast<std::uint8_t>(label), picture);
    }
    return fill_rest(holes, picture);
  }

 private:
  /// A pixel of the window: its label, and whether it is still to be filled.
  struct State {
    std::uint8_t label;
    bool open;
  };

  void collect_states(const Mask& missing, const Reconstruction& reconstruction) {
    states_.resize(window_.width, window_.height);
    boxes_.fill({});
    for (int y = 0; y < window_.height; ++y) {
      for (int x = 0; x < window_.width; ++x) {
        const bool drawn = reconstruction.region.contains(window_.x + x, window_.y + y);
        const std::uint8_t label = drawn ? reconstruction.surface(window_.x + x, window_.y + y)
                                         : surface_label::unknown;
        const bool open = missing(window_.x + x, window_.y + y) != 0;
        states_(x, y) = {label, open};
        if (open) extend(boxes_[label], x, y);
      }
    }
  }
  static void extend(Rect& box, int x, int y) {
    if (box.empty()) {
      box = {x, y, 1, 1};
      return;
    }
    const int right = std::max(box.right(), x + 1);
    const int bottom = std::max(box.bottom(), y + 1);
    box.x = std::min(box.x, x);
    box.y = std::min(box.y, y);
    box.width = right - box.x;
    box.height = bottom - box.y;
  }

  void fill_plane(std::uint8_t label, Image<Bgr>& picture) {
    const Rect part = intersect(grow(boxes_[label], 1), states_.bounds());
    solve(part, picture, [label](const State& state) -> std::uint8_t {
      if (state.label != label) return 0;
      return state.open ? 1 : MembraneSolver::fixed;
    });
  }

  bool fill_rest(const Rect& holes, Image<Bgr>& picture) {
    Rect rest;
    for (int y = 0; y < window_.height; ++y) {
      for (int x = 0; x < window_.width; ++x) {
        if (states_(x, y).open) extend(rest, x, y);
      }
    }
    if (rest.empty()) return true;
    const Rect part = intersect(grow(rest, 1), states_.bounds());
    const bool anything_known = solve(part, picture, [](const State& state) -> std::uint8_t {
      return state.open ? 1 : MembraneSolver::fixed;
    });
    if (!anything_known) picture.fill(holes, {});
    return anything_known;
  }

  /// Fills the pixels of `part` (of the window) whose key is 1 and that hang together with a fixed
  /// one. Returns whether there was one.
  template <class Key>
  bool solve(const Rect& part, Image<Bgr>& picture, const Key& key) {
    solver_.begin(part.width, part.height);
    for_rows(part.height, [&](Rows rows) {
      for (int row = rows.first; row < rows.last; ++row) {
        const State* states = states_.row(part.y + row) + part.x;
        std::uint8_t* keys = solver_.keys(row);
        for (int i = 0; i < part.width; ++i) keys[i] = key(states[i]);
      }
    });
    solver_.connect();
    const Rect in_picture{window_.x + part.x, window_.y + part.y, part.width, part.height};
    bool anything_known = false;
    solver_.for_each_fixed([&](int x, int y) {
      const Bgr& color = picture(in_picture.x + x, in_picture.y + y);
      solver_.set_fixed(
          x, y,
          {static_cast<float>(color.b), static_cast<float>(color.g), static_cast<float>(color.r)});
      anything_known = true;
    });
    if (!anything_known) return false;
    solver_.take_out_loose_parts();
    solver_.solve(tolerance_levels);
    write_solution(solver_, in_picture, picture);
    for (int y = 0; y < part.height; ++y) {
      const std::uint8_t* keys = solver_.keys(y);
      State* states = states_.row(part.y + y) + part.x;
      for (int i = 0; i < part.width; ++i) {
        if (keys[i] == 1) states[i].open = false;
      }
    }
    return true;
  }

  MembraneSolver solver_;
  Rect window_;
  Image<State> states_;
  std::array<Rect, 256> boxes_;
};

const bool registered =
    Registry<Inpainter>::add("surfaces", [] { return std::make_unique<SurfaceInpainting>(); });

}  // namespace
}  // namespace diminish
