#include "inpaint/surface_inpainting.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/channels.h"
#include "core/conditions.h"
#include "core/connected_regions.h"
#include "core/rows.h"
#include "core/runs.h"
#include "core/tasks.h"
#include "inpaint/far_side.h"
#include "inpaint/plane_colors.h"
#include "inpaint/surface_rules.h"
#include "membrane/smooth_filling.h"
#include "scene/thing_step.h"

namespace diminish {
namespace {

/// A pixel of the window: what it shows (surface_label, in seven bits), and whether it is open,
/// that is, still to be filled.
namespace state {
using Code = std::uint8_t;
constexpr Code open = 0x80;
constexpr Code label_bits = 0x7F;
constexpr Code foreground = surface_label::foreground & label_bits;
/// Beyond the picture, or in front of what is to be filled: never filled, nothing to fill from.
constexpr Code outside = open | label_bits;
/// Known, but not drawn: the plane is a guess. Together with a plane's label.
constexpr Code guessed = 0x40;
/// Not drawn, but the side of a thing (surface_label::standing).
constexpr Code standing = surface_rules::labels;
static_assert(standing < guessed);

/// Of a row of pixels, some missing. By value, so that the loop is vectorised.
void find_codes(const std::uint8_t* missing, const std::uint8_t* labels, int count, Code* codes) {
  for (int i = 0; i < count; ++i) {
    const std::uint8_t label = labels[i];
    const Code beyond_planes = label == surface_label::standing ? standing : surface_label::unknown;
    const Code wanted = label < surface_rules::labels ? label : beyond_planes;
    const Code is_open = missing[i] & open;
    const auto known = static_cast<Code>(label & label_bits);
    codes[i] = static_cast<Code>(is_open | (is_open != 0 ? wanted : known));
  }
}
}  // namespace state

/// Fills each plane of the background from its own pixels alone, as smoothly as can be: what stands
/// in front of a wall does not bleed onto it, and where table and wall meet there is an edge. What
/// is left is filled from all pixels around, but for what stands in front of it (FarSide).
class SurfaceInpainting : public Inpainter {
 public:
  explicit SurfaceInpainting(FillFrom from) : from_(from) {}

  Declaration declaration() const override {
    return {.uses_surfaces = true, .rule = Declaration::Rule::by_surface};
  }

  bool inpaint(const Holes& holes, const Options&, Image<Bgr>& picture) override {
    window_ = grow(bounding_box(holes.missing, holes.part()), 1);
    if (window_.empty()) return true;
    do_all([&] { plane_colors_.collect(holes.occlusion, holes.surfaces, picture); },
           [&] {
             collect_states(holes);
             find_holes();
             if (uses_depth(holes)) leave_out_front(holes);
           });
    // They do not depend on each other: what one fills no other takes for known.
    std::array<bool, label_count> filled{};
    for_tasks(label_count,
              [&](std::size_t k) { filled[k] = fill(static_cast<Label>(k), holes, picture); });
    return fill_rest(filled, holes, picture);
  }

 private:
  using Label = std::uint8_t;
  static constexpr std::size_t label_count = state::standing + 1;

  /// Row y of the picture, to be indexed by the picture's x.
  state::Code* state_row(int y) { return states_.row(y - window_.y) - window_.x; }
  const state::Code* state_row(int y) const { return states_.row(y - window_.y) - window_.x; }

  bool uses_depth(const Holes& holes) const {
    return from_ == FillFrom::far_side && !holes.depth_m.empty();
  }

  void collect_states(const Holes& holes) {
    states_.resize(window_.width, window_.height);
    const Surfaces& surfaces = holes.surfaces;
    const Rect seen = intersect(window_, holes.missing.bounds());
    const Rect drawn = intersect(intersect(surfaces.region, surfaces.label.bounds()), seen);
    const bool marks_guesses = uses_depth(holes);
    const auto collect_row = [&](int y, OpenRuns& open_runs) {
      state::Code* const states = state_row(y);
      std::fill(states + window_.x, states + window_.right(), state::outside);
      if (y < seen.y || y >= seen.bottom()) return;
      const std::uint8_t* const missing = holes.missing.row(y);
      std::transform(missing + seen.x, missing + seen.right(), states + seen.x,
                     [](std::uint8_t is_missing) { return is_missing & state::open; });
      if (y >= drawn.y && y < drawn.bottom()) {
        state::find_codes(missing + drawn.x, surfaces.label.row(y) + drawn.x, drawn.width,
                          states + drawn.x);
        if (marks_guesses) {
          mark_guesses(holes.depth_m.row(y) + drawn.x, drawn.width, states + drawn.x);
        }
      }
      for_each_run(missing, seen.x, seen.right(), Pixels::set, [&](int first, int last) {
        for (int end; first < last; first = end) {
          end = find_other(states, first, last, states[first]);
          open_runs[states[first] & state::label_bits].push_back(
              {y - window_.y, first - window_.x, end - window_.x});
        }
      });
    };
    for (OpenRuns& band : open_runs_) {
      for (auto& runs : band) runs.clear();
    }
    for_rows(window_.height, [&](Rows rows) {
      for (int y = rows.first; y < rows.last; ++y) {
        collect_row(window_.y + y, open_runs_[static_cast<std::size_t>(rows.band)]);
      }
    });
  }

  static void mark_guesses(const float* depth_m, int count, state::Code* states) {
    for (int i = 0; i < count; ++i) {
      const bool is_guess = all_of(states[i] >= surface_label::first_plane,
                                   states[i] < surface_rules::labels, depth_m[i] == 0);
      states[i] |= is_guess ? state::guessed : 0;
    }
  }

  /// Finds where the holes of each label are, and takes the label from those that mostly border on
  /// what is in front of their plane.
  void find_holes() {
    boxes_.fill({});
    for (std::size_t k = 0; k < label_count; ++k) {
      const auto label = static_cast<Label>(k);
      regions_.begin();
      for (const OpenRuns& band : open_runs_) {
        for (const OpenRun& run : band[k]) regions_.add(run.y, run.first, run.last);
      }
      if (regions_.runs().empty()) continue;
      regions_.connect(Connectivity::four);
      const bool is_plane = label != surface_label::unknown && label != state::standing;
      if (is_plane) count_rims(label);
      for (std::size_t i = 0; i < regions_.regions().size(); ++i) {
        const bool is_kept = !is_plane || is_on_plane(rims_[i]);
        if (is_plane && is_kept && trusts_guesses(rims_[i])) {
          believe_guesses(regions_.regions()[i], label);
        }
        Rect& box = boxes_[is_kept ? k : std::size_t{surface_label::unknown}];
        box = join(box, regions_.regions()[i].box);
      }
      if (!is_plane) continue;
      for (const ConnectedRegions::Run& run : regions_.runs()) {
        if (is_on_plane(rims_[static_cast<std::size_t>(run.region)])) continue;
        state::Code* const row = states_.row(run.y);
        std::fill(row + run.first, row + run.last, state::open | surface_label::unknown);
      }
    }
    // They were found in the window.
    for (Rect& box : boxes_) {
      box.x += window_.x;
      box.y += window_.y;
    }
  }

  /// Pixels beside a hole.
  struct Rim {
    int plane = 0, guessed = 0, foreground = 0;
  };
  /// Where little of a hole's rim was drawn, all of it that may lie on the plane lends its colour.
  static bool trusts_guesses(const Rim& rim) { return rim.plane < rim.guessed; }
  static bool is_on_plane(const Rim& rim) {
    const int plane = rim.plane + (trusts_guesses(rim) ? rim.guessed : 0);
    return 100 * plane >= surface_rules::plane_rim_percent * (plane + rim.foreground);
  }

  void count_rims(Label label) {
    rims_.assign(regions_.regions().size(), {});
    for (const ConnectedRegions::Run& run : regions_.runs()) {
      Rim& rim = rims_[static_cast<std::size_t>(run.region)];
      const auto add = [&](state::Code beside) {
        rim.plane += beside == label ? 1 : 0;
        rim.guessed += beside == (label | state::guessed) ? 1 : 0;
        rim.foreground += beside == state::foreground ? 1 : 0;
      };
      // Most of what is above or below is of the hole, too.
      const auto count = [&](int y, int first, int last) {
        const state::Code* const row = states_.row(y);
        for (int x = first; (x = find_without(row, x, last, state::open)) < last; ++x) {
          add(row[x]);
        }
      };
      // The window holds a pixel more on each side.
      const state::Code* const own = states_.row(run.y);
      add(own[run.first - 1]);
      add(own[run.last]);
      count(run.y - 1, run.first, run.last);
      count(run.y + 1, run.first, run.last);
    }
  }

  /// Takes the plane that was guessed of the pixels beside a hole for theirs.
  void believe_guesses(const ConnectedRegions::Region& hole, Label label) {
    const auto believe = [label](state::Code& code) {
      if (code == (label | state::guessed)) code = label;
    };
    regions_.for_each_run(hole, [&](const ConnectedRegions::Run& run) {
      state::Code* const own = states_.row(run.y);
      believe(own[run.first - 1]);
      believe(own[run.last]);
      for (const int y : {run.y - 1, run.y + 1}) {
        std::for_each(states_.row(y) + run.first, states_.row(y) + run.last, believe);
      }
    });
  }

  /// What stands in front of a hole that is filled from all around lends it no colour.
  void leave_out_front(const Holes& holes) {
    const Rect measured = intersect(holes.surfaces.region, holes.depth_m.bounds());
    const state::Code hole = state::open | surface_label::unknown;
    for (const FarSide::Place& place :
         far_side_.find_front({states_, window_, hole, state::open, holes.depth_m, measured})) {
      states_(place.x, place.y) = state::outside;
    }
  }

  /// What has a label of which nothing is known. What has been filled is known now.
  bool fill_rest(const std::array<bool, label_count>& filled, const Holes& holes,
                 Image<Bgr>& picture) {
    if (std::all_of(filled.begin(), filled.end(), [](bool is) { return is; })) return true;
    Rect& rest = boxes_[surface_label::unknown];
    if (filled[surface_label::unknown]) rest = {};
    for (std::size_t k = surface_label::first_plane; k < label_count; ++k) {
      if (!filled[k]) rest = join(rest, boxes_[k]);
    }
    for (state::Code& code : states_) {
      const Label label = code & state::label_bits;
      if ((code & state::open) == 0 || label >= label_count) continue;
      code = filled[label] ? label : state::open | surface_label::unknown;
    }
    if (fill(surface_label::unknown, holes, picture)) return true;
    for (int y = rest.y; y < rest.bottom(); ++y) {
      const state::Code* const states = state_row(y);
      for (int x = rest.x; x < rest.right(); ++x) {
        if ((states[x] & state::open) != 0) picture(x, y) = {};
      }
    }
    return false;
  }

  /// The colour that a known pixel hands on.
  Eigen::Array3f color_of(int x, int y, const Holes& holes, const Image<Bgr>& picture) const {
    Eigen::Array3f own = to_channels(picture(x, y));
    Eigen::Array3f around;
    const Label label = state_row(y)[x];
    if (holes.occlusion(x, y) != 0 || !plane_colors_.around(x, y, label, around)) return own;
    return own.sum() < surface_rules::shadow * around.sum() ? around : own;
  }

  /// By value, so that the loop is vectorised.
  static void find_kinds(const state::Code* states, int width, state::Code label, state::Code open,
                         state::Code known_bits, SmoothFilling::Kind* kinds) {
    for (int x = 0; x < width; ++x) {
      const bool is_known = (states[x] & known_bits) == label;
      kinds[x] = static_cast<SmoothFilling::Kind>((is_known ? SmoothFilling::known : 0) |
                                                  (states[x] == open ? SmoothFilling::open : 0));
    }
  }

  /// A thing's side takes its colours from the thing alone.
  void find_sides(const Rect& box, const Holes& holes, Image<SmoothFilling::Kind>& kinds) const {
    kinds.fill(SmoothFilling::absent);
    const Image<float>& side_m = holes.surfaces.standing_depth_m;
    const Rect measured = intersect(holes.surfaces.region, holes.depth_m.bounds());
    for (int y = box.y; y < box.bottom(); ++y) {
      constexpr state::Code open_side = state::open | state::standing;
      SmoothFilling::Kind* const own = kinds.row(y - box.y + 1);
      for_each_run(state_row(y), box.x, box.right(), open_side, [&](int first, int last) {
        std::fill(own + first - box.x + 1, own + last - box.x + 1, SmoothFilling::open);
        // A pixel of the thing, and the side's pixel beside it.
        const auto border_on = [&](int column, int row, int x) {
          if (measured.contains(column, row) &&
              may_be_one_thing(holes.depth_m(column, row), side_m(x, y))) {
            kinds(column - box.x + 1, row - box.y + 1) = SmoothFilling::known;
          }
        };
        if (state_row(y)[first - 1] == state::foreground) border_on(first - 1, y, first);
        if (state_row(y)[last] == state::foreground) border_on(last, y, last - 1);
        for (const int row : {y - 1, y + 1}) {
          for (int x = first; (x = find_equal(state_row(row), x, last, state::foreground)) < last;
               ++x) {
            border_on(x, row, x);
          }
        }
      });
    }
  }

  /// Fills the open pixels with this label. Returns false if nothing is known beside them.
  bool fill(Label label, const Holes& holes, Image<Bgr>& picture) {
    const Rect& box = boxes_[label];
    if (box.empty()) return true;
    SmoothFilling& filling = fillings_[label];
    Image<SmoothFilling::Kind>& kinds = filling.begin(box);
    const state::Code open = state::open | label;
    const state::Code known_bits =
        label == surface_label::unknown ? state::open : static_cast<state::Code>(0xFF);
    if (label == state::standing) {
      find_sides(box, holes, kinds);
    } else {
      for_rows(kinds.height(), [&](Rows rows) {
        for (int y = rows.first; y < rows.last; ++y) {
          find_kinds(state_row(box.y - 1 + y) + box.x - 1, kinds.width(), label, open, known_bits,
                     kinds.row(y));
        }
      });
    }
    if (!filling.connect([&](int x, int y) { return color_of(x, y, holes, picture); })) {
      return false;
    }
    filling.solve();
    filling.for_each_run([&](int y, int first, int last, const Eigen::Array4f* colors) {
      filling_rows::round(colors + first, last - first, picture.row(y) + first);
    });
    return true;
  }

  FillFrom from_;
  PlaneColors plane_colors_;
  Rect window_;  ///< in the picture, which it may reach out of
  Image<state::Code> states_;
  std::array<Rect, label_count> boxes_;              ///< of the holes of each label, in the picture
  std::array<SmoothFilling, label_count> fillings_;  ///< by label
  /// Of open pixels with one label; in the window.
  struct OpenRun {
    int y, first, last;
  };
  using OpenRuns = std::array<std::vector<OpenRun>, label_count>;  ///< by label
  std::array<OpenRuns, most_bands> open_runs_;
  ConnectedRegions regions_;
  std::vector<Rim> rims_;
  FarSide far_side_;
};

const bool surface_inpainting_registered = Registry<Inpainter>::add(
    "surfaces", [] { return make_surface_inpainting(FillFrom::all_sides); });

}  // namespace

std::unique_ptr<Inpainter> make_surface_inpainting(FillFrom from) {
  return std::make_unique<SurfaceInpainting>(from);
}

}  // namespace diminish
