#include <array>
#include <vector>

#include "composite/channels.h"
#include "composite/connected_runs.h"
#include "composite/membrane_picture.h"
#include "composite/membrane_solver.h"
#include "composite/plane_colors.h"
#include "core/rows.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

/// Of the last multigrid correction; what is left of the error is smaller.
constexpr float tolerance_levels = 1.F;

/// A pixel of the window: the plane that it shows, and whether it is still to be filled.
struct State {
  std::uint8_t label;
  bool open;
};

/// Fills each plane of the background from its own pixels alone, as smoothly as can be: what stands
/// in front of a wall does not bleed onto it, and where table and wall meet there is an edge. What
/// is left is filled from all pixels around.
class SurfaceInpainting : public Inpainter {
 public:
  bool inpaint(const Holes& holes, const Options&, Image<Bgr>& picture) override {
    const Rect box = bounding_box(holes.missing);
    if (box.empty()) return true;
    window_ = intersect(grow(box, 1), picture.bounds());
    plane_colors_.collect(holes.occlusion, holes.reconstruction, picture);
    collect_states(holes);
    for (int label = surface_label::first_plane; label < surface_label::foreground; ++label) {
      const Rect part = boxes_[static_cast<std::size_t>(label)];
      if (!part.empty()) fill_plane(static_cast<std::uint8_t>(label), part, holes, picture);
    }
    return fill_rest(holes, picture);
  }

 private:
  /// Of a hole's rim on measured surfaces, at least so much must lie on the hole's plane; else the
  /// hole is rather one in what stands in front of it.
  static constexpr int plane_rim_percent = 60;

  void collect_states(const Holes& holes) {
    states_.resize(window_.width, window_.height);
    boxes_.fill({});
    const Reconstruction& reconstruction = holes.reconstruction;
    for (int y = 0; y < window_.height; ++y) {
      for (int x = 0; x < window_.width; ++x) {
        const bool drawn = reconstruction.region.contains(window_.x + x, window_.y + y);
        const std::uint8_t label = drawn ? reconstruction.surface(window_.x + x, window_.y + y)
                                         : surface_label::unknown;
        const bool open = holes.missing(window_.x + x, window_.y + y) != 0;
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

  void fill_plane(std::uint8_t label, const Rect& holes_box, const Holes& holes,
                  Image<Bgr>& picture) {
    give_up_holes_in_foreground(label, holes_box);
    const Rect part = intersect(grow(holes_box, 1), states_.bounds());
    solve(part, holes, picture, [label](const State& state) -> std::uint8_t {
      if (state.label != label) return 0;
      return state.open ? 1 : MembraneSolver::fixed;
    });
  }

  bool fill_rest(const Holes& holes, Image<Bgr>& picture) {
    Rect rest;
    for (int y = 0; y < window_.height; ++y) {
      for (int x = 0; x < window_.width; ++x) {
        if (states_(x, y).open) extend(rest, x, y);
      }
    }
    if (rest.empty()) return true;
    const Rect part = intersect(grow(rest, 1), states_.bounds());
    const bool anything_known = solve(part, holes, picture, [](const State& state) -> std::uint8_t {
      return state.open ? 1 : MembraneSolver::fixed;
    });
    if (!anything_known) picture.fill(bounding_box(holes.missing), {});
    return anything_known;
  }

  /// Takes the label from the holes that mostly border on what is in front of their plane.
  void give_up_holes_in_foreground(std::uint8_t label, const Rect& box) {
    const int words = (box.width + 31) / 32;
    bits_.assign(static_cast<std::size_t>(words) * static_cast<std::size_t>(box.height), 0);
    for (int y = 0; y < box.height; ++y) {
      const State* states = states_.row(box.y + y) + box.x;
      std::uint32_t* bits = bits_.data() + static_cast<std::ptrdiff_t>(y) * words;
      for (int x = 0; x < box.width; ++x) {
        if (states[x].open && states[x].label == label) bits[x / 32] |= 1U << (x % 32);
      }
    }
    parts_.find(bits_.data(), words, words, box.height);
    rims_.assign(parts_.part_limit(), {});
    const auto count = [&](Rim& rim, int x, int y) {
      if (!states_.bounds().contains(x, y) || states_(x, y).open) return;
      rim.plane += states_(x, y).label == label ? 1 : 0;
      rim.foreground += states_(x, y).label == surface_label::foreground ? 1 : 0;
    };
    for (int y = 0; y < box.height; ++y) {
      for (const ConnectedRuns::Run& run : parts_.row(y)) {
        Rim& rim = rims_[run.part];
        count(rim, box.x + run.first - 1, box.y + y);
        count(rim, box.x + run.last, box.y + y);
        for (int x = run.first; x < run.last; ++x) {
          count(rim, box.x + x, box.y + y - 1);
          count(rim, box.x + x, box.y + y + 1);
        }
      }
    }
    for (int y = 0; y < box.height; ++y) {
      for (const ConnectedRuns::Run& run : parts_.row(y)) {
        const Rim& rim = rims_[run.part];
        if (100 * rim.plane >= plane_rim_percent * (rim.plane + rim.foreground)) continue;
        State* states = states_.row(box.y + y) + box.x;
        for (int x = run.first; x < run.last; ++x) states[x].label = surface_label::unknown;
      }
    }
  }

  /// The colour that a known pixel hands on.
  Eigen::Array3f color_of(int x, int y, const Holes& holes, const Image<Bgr>& picture) const {
    constexpr float shadow = 0.85F;
    const Eigen::Array3f own = to_channels(picture(x, y));
    if (holes.occlusion(x, y) != 0) return own;
    Eigen::Array3f around;
    const Rect& region = holes.reconstruction.region;
    if (!region.contains(x, y) ||
        !plane_colors_.around(x, y, holes.reconstruction.surface(x, y), around)) {
      return own;
    }
    return own.sum() < shadow * around.sum() ? around : own;
  }

  /// Fills the pixels of `part` (of the window) whose key is 1 and that hang together with a fixed
  /// one. Returns whether there was one.
  template <class Key>
  bool solve(const Rect& part, const Holes& holes, Image<Bgr>& picture, const Key& key) {
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
      const Eigen::Array3f color = color_of(in_picture.x + x, in_picture.y + y, holes, picture);
      solver_.set_fixed(x, y, {color[0], color[1], color[2]});
      anything_known = true;
    });
    if (!anything_known) return false;
    solver_.take_out_loose_parts();
    solver_.solve(tolerance_levels);
    write_solution(solver_, in_picture, picture);
    for (int y = 0; y < part.height; ++y) {
      const std::uint8_t* keys = solver_.keys(y);
      State* states = states_.row(part.y + y) + part.x;
      for (int i = 0; i < part.width; ++i) states[i].open = states[i].open && keys[i] != 1;
    }
    return true;
  }

  /// Pixels beside a hole.
  struct Rim {
    int plane = 0, foreground = 0;
  };

  MembraneSolver solver_;
  PlaneColors plane_colors_;
  Rect window_;  ///< in the picture
  Image<State> states_;
  std::array<Rect, 256> boxes_;  ///< of the holes in each plane, in the window
  std::vector<std::uint32_t> bits_;
  ConnectedRuns parts_;
  std::vector<Rim> rims_;
};

const bool registered =
    Registry<Inpainter>::add("surfaces", [] { return std::make_unique<SurfaceInpainting>(); });

}  // namespace
}  // namespace diminish
