#include <oneapi/tbb/parallel_for.h>

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
    for (std::size_t k = 0; k < planes; ++k) give_up_holes_in_foreground(k);
    // They do not depend on each other: what one fills no other takes for known. Pictures are
    // written a block of pixels at a time, so not side by side.
    std::array<bool, label_count> solved{};
    oneapi::tbb::parallel_for(std::size_t{0}, label_count, [&](std::size_t k) {
      const auto label = static_cast<std::uint8_t>(k);
      if (boxes_[k].empty()) return;
      const auto key = [label](const State& state) -> std::uint8_t {
        if (state.open) return state.label == label ? 1 : 0;
        const bool is_known = label == surface_label::unknown || state.label == label;
        return is_known ? MembraneSolver::fixed : 0;
      };
      solved[k] = solve(boxes_[k], solvers_[k], holes, picture, key);
    });
    for (std::size_t k = 0; k < label_count; ++k) {
      if (solved[k]) write(boxes_[k], solvers_[k], picture);
    }
    return fill_rest(holes, picture);
  }

 private:
  static constexpr std::size_t planes = PlaneColors::planes;
  static constexpr std::size_t label_count = surface_label::first_plane + planes;
  /// Of a hole's rim on measured surfaces, at least so much must lie on the hole's plane; else the
  /// hole is rather one in what stands in front of it.
  static constexpr int plane_rim_percent = 60;

  void collect_states(const Holes& holes) {
    states_.resize(window_.width, window_.height);
    boxes_.fill({});
    const Reconstruction& reconstruction = holes.reconstruction;
    const Rect drawn = intersect(reconstruction.region, reconstruction.surface.bounds());
    for (int y = 0; y < window_.height; ++y) {
      const int row = window_.y + y;
      const bool is_drawn = row >= drawn.y && row < drawn.bottom();
      const std::uint8_t* missing = holes.missing.row(row) + window_.x;
      const std::uint8_t* surface =
          is_drawn ? reconstruction.surface.row(row) + window_.x : nullptr;
      State* states = states_.row(y);
      for (int x = 0; x < window_.width; ++x) {
        const int column = window_.x + x;
        std::uint8_t label = surface_label::unknown;
        if (is_drawn && column >= drawn.x && column < drawn.right()) label = surface[x];
        states[x] = {label, missing[x] != 0};
        if (states[x].open) extend(boxes_[label], x, y);
      }
    }
  }

  /// What hangs together with no pixel of its own plane.
  bool fill_rest(const Holes& holes, Image<Bgr>& picture) {
    Rect rest;
    for (int y = 0; y < window_.height; ++y) {
      const State* states = states_.row(y);
      for (int x = 0; x < window_.width; ++x) {
        if (states[x].open) extend(rest, x, y);
      }
    }
    if (rest.empty()) return true;
    MembraneSolver& solver = solvers_[surface_label::unknown];
    const bool anything_known = solve(
        rest, solver, holes, picture,
        [](const State& state) -> std::uint8_t { return state.open ? 1 : MembraneSolver::fixed; });
    if (anything_known) {
      write(rest, solver, picture);
    } else {
      picture.fill(bounding_box(holes.missing), {});
    }
    return anything_known;
  }

  /// Takes the label from the holes that mostly border on what is in front of their plane.
  void give_up_holes_in_foreground(std::size_t plane) {
    const auto label = static_cast<std::uint8_t>(surface_label::first_plane + plane);
    const Rect box = boxes_[label];
    if (box.empty()) return;
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
        extend(boxes_[surface_label::unknown], box.x + run.first, box.y + y);
        extend(boxes_[surface_label::unknown], box.x + run.last - 1, box.y + y);
      }
    }
  }

  /// The colour that a known pixel hands on.
  Eigen::Array3f color_of(int x, int y, std::uint8_t label, const Holes& holes,
                          const Image<Bgr>& picture) const {
    constexpr float shadow = 0.85F;
    const Eigen::Array3f own = to_channels(picture(x, y));
    Eigen::Array3f around;
    if (holes.occlusion(x, y) != 0 || !plane_colors_.around(x, y, label, around)) return own;
    return own.sum() < shadow * around.sum() ? around : own;
  }

  Rect with_rim(const Rect& box) const { return intersect(grow(box, 1), states_.bounds()); }

  /// Solves for the pixels of `box` (of the window) whose key is 1 and that hang together with a
  /// fixed one. Returns whether there was one.
  template <class Key>
  bool solve(const Rect& box, MembraneSolver& solver, const Holes& holes, const Image<Bgr>& picture,
             const Key& key) const {
    const Rect part = with_rim(box);
    solver.begin(part.width, part.height);
    for_rows(part.height, [&](Rows rows) {
      for (int row = rows.first; row < rows.last; ++row) {
        const State* states = states_.row(part.y + row) + part.x;
        std::uint8_t* keys = solver.keys(row);
        for (int i = 0; i < part.width; ++i) keys[i] = key(states[i]);
      }
    });
    solver.connect();
    bool anything_known = false;
    solver.for_each_fixed([&](int x, int y) {
      const Eigen::Array3f color = color_of(window_.x + part.x + x, window_.y + part.y + y,
                                            states_(part.x + x, part.y + y).label, holes, picture);
      solver.set_fixed(x, y, {color[0], color[1], color[2]});
      anything_known = true;
    });
    if (!anything_known) return false;
    solver.take_out_loose_parts();
    solver.solve(tolerance_levels);
    return true;
  }

  void write(const Rect& box, const MembraneSolver& solver, Image<Bgr>& picture) {
    const Rect part = with_rim(box);
    write_solution(solver, {window_.x + part.x, window_.y + part.y, part.width, part.height},
                   picture);
    for (int y = 0; y < part.height; ++y) {
      const std::uint8_t* keys = solver.keys(y);
      State* states = states_.row(part.y + y) + part.x;
      for (int i = 0; i < part.width; ++i) states[i].open = states[i].open && keys[i] != 1;
    }
  }

  /// Pixels beside a hole.
  struct Rim {
    int plane = 0, foreground = 0;
  };

  PlaneColors plane_colors_;
  Rect window_;  ///< in the picture
  Image<State> states_;
  std::array<Rect, 256> boxes_;                      ///< of the holes of each label, in the window
  std::array<MembraneSolver, label_count> solvers_;  ///< by label
  std::vector<std::uint32_t> bits_;
  ConnectedRuns parts_;
  std::vector<Rim> rims_;
};

const bool registered =
    Registry<Inpainter>::add("surfaces", [] { return std::make_unique<SurfaceInpainting>(); });

}  // namespace
}  // namespace diminish
