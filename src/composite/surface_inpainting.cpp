#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <vector>

#include "composite/connected_runs.h"
#include "composite/plane_colors.h"
#include "composite/smooth_filling.h"
#include "core/channels.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

/// A pixel of the window: what it shows (surface_label, in seven bits), and whether it is open,
/// that is, still to be filled.
namespace state {
using Code = std::uint8_t;
constexpr Code open = 0x80;
constexpr Code label_bits = 0x7F;
constexpr Code foreground = surface_label::foreground & label_bits;
}  // namespace state

/// Fills each plane of the background from its own pixels alone, as smoothly as can be: what stands
/// in front of a wall does not bleed onto it, and where table and wall meet there is an edge. What
/// is left is filled from all pixels around.
class SurfaceInpainting : public Inpainter {
 public:
  bool uses_surfaces() const override { return true; }

  bool inpaint(const Holes& holes, const Options&, Image<Bgr>& picture) override {
    const Rect box = bounding_box(holes.missing);
    if (box.empty()) return true;
    window_ = intersect(grow(box, 1), picture.bounds());
    oneapi::tbb::parallel_invoke(
        [&] { plane_colors_.collect(holes.occlusion, holes.reconstruction, picture); },
        [&] {
          collect_states(holes);
          for (std::size_t k = 0; k < planes; ++k) give_up_holes_in_foreground(k);
        });
    // They do not depend on each other: what one fills no other takes for known.
    std::array<bool, most_labels> filled{};
    for (std::size_t k = label_count; k < most_labels; ++k) filled[k] = boxes_[k].empty();
    oneapi::tbb::parallel_for(std::size_t{0}, label_count, [&](std::size_t k) {
      filled[k] = fill(static_cast<std::uint8_t>(k), holes, picture);
    });
    return fill_rest(filled, holes, picture);
  }

 private:
  static constexpr std::size_t planes = PlaneColors::planes;
  static constexpr std::size_t most_labels = 128;
  static constexpr std::size_t label_count = surface_label::first_plane + planes;
  /// Of a hole's rim on measured surfaces, at least so much must lie on the hole's plane; else the
  /// hole is rather one in what stands in front of it.
  static constexpr int plane_rim_percent = 60;

  void collect_states(const Holes& holes) {
    states_.resize(window_.width, window_.height);
    boxes_.fill({});
    const Reconstruction& reconstruction = holes.reconstruction;
    const Rect drawn =
        intersect(intersect(reconstruction.region, reconstruction.surface.bounds()), window_);
    for (int y = 0; y < window_.height; ++y) {
      const int row = window_.y + y;
      const std::uint8_t* missing = holes.missing.row(row) + window_.x;
      state::Code* states = states_.row(y);
      for (int x = 0; x < window_.width; ++x) states[x] = missing[x] & state::open;
      if (row >= drawn.y && row < drawn.bottom()) {
        const std::uint8_t* surface = reconstruction.surface.row(row) + window_.x;
        const int end = drawn.right() - window_.x;
        for (int x = drawn.x - window_.x; x < end; ++x) states[x] |= surface[x] & state::label_bits;
      }
      for_each_open(y, [&](int x) { extend(boxes_[states[x] & state::label_bits], x, y); });
    }
  }

  /// Calls visit(x) for each open pixel of a row.
  template <class Visit>
  void for_each_open(int y, const Visit& visit) const {
    const state::Code* states = states_.row(y);
    constexpr int step = 8;
    for (int x = 0; x < window_.width; x += step) {
      const int end = std::min(x + step, window_.width);
      state::Code any = 0;
      for (int i = x; i < end; ++i) any |= states[i];
      if ((any & state::open) == 0) continue;
      for (int i = x; i < end; ++i) {
        if ((states[i] & state::open) != 0) visit(i);
      }
    }
  }

  /// What has a label of which nothing is known.
  bool fill_rest(const std::array<bool, most_labels>& filled, const Holes& holes,
                 Image<Bgr>& picture) {
    if (std::all_of(filled.begin(), filled.end(), [](bool is) { return is; })) return true;
    Rect& rest = boxes_[surface_label::unknown];
    rest = {};
    for (int y = 0; y < window_.height; ++y) {
      for_each_open(y, [&](int x) {
        state::Code& code = states_(x, y);
        const state::Code label = code & state::label_bits;
        code = filled[label] ? label : state::open | surface_label::unknown;
        if (!filled[label]) extend(rest, x, y);
      });
    }
    if (fill(surface_label::unknown, holes, picture)) return true;
    for (int y = 0; y < window_.height; ++y) {
      for_each_open(y, [&](int x) { picture(window_.x + x, window_.y + y) = {}; });
    }
    return false;
  }

  /// Takes the label from the holes that mostly border on what is in front of their plane.
  void give_up_holes_in_foreground(std::size_t plane) {
    const auto label = static_cast<std::uint8_t>(surface_label::first_plane + plane);
    const Rect box = boxes_[label];
    if (box.empty()) return;
    const int words = (box.width + 31) / 32;
    bits_.assign(static_cast<std::size_t>(words) * static_cast<std::size_t>(box.height), 0);
    for (int y = 0; y < box.height; ++y) {
      const state::Code* states = states_.row(box.y + y) + box.x;
      std::uint32_t* bits = bits_.data() + static_cast<std::ptrdiff_t>(y) * words;
      for (int x = 0; x < box.width; ++x) {
        if (states[x] == (state::open | label)) bits[x / 32] |= 1U << (x % 32);
      }
    }
    parts_.find(bits_.data(), words, words, box.height);
    rims_.assign(parts_.part_limit(), {});
    const auto count = [&](Rim& rim, int x, int y) {
      if (!states_.bounds().contains(x, y)) return;
      rim.plane += states_(x, y) == label ? 1 : 0;
      rim.foreground += states_(x, y) == state::foreground ? 1 : 0;
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
        state::Code* states = states_.row(box.y + y) + box.x;
        std::fill(states + run.first, states + run.last, state::open | surface_label::unknown);
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

  /// Fills the open pixels with this label. Returns false if nothing is known beside them.
  bool fill(std::uint8_t label, const Holes& holes, Image<Bgr>& picture) {
    const Rect& box = boxes_[label];
    if (box.empty()) return true;
    const int left = box.x;
    const int top = box.y;
    SmoothFilling& filling = fillings_[label];
    filling.begin(box.width, box.height);
    for (int y = box.y; y < box.bottom(); ++y) {
      const state::Code* states = states_.row(y);
      for_each_open(y, [&](int x) {
        if (states[x] == (state::open | label)) filling.open(x - left, y - top);
      });
    }
    const auto is_known = [&](int x, int y) {
      if (!states_.bounds().contains(left + x, top + y)) return false;
      const state::Code code = states_(left + x, top + y);
      return label == surface_label::unknown ? (code & state::open) == 0 : code == label;
    };
    const auto color = [&](int x, int y) {
      return color_of(window_.x + left + x, window_.y + top + y, states_(left + x, top + y), holes,
                      picture);
    };
    if (filling.empty()) return true;
    if (!filling.connect(is_known, color)) return false;
    filling.solve();
    filling.for_each([&](int x, int y, const Eigen::Array4f& channels) {
      const auto level = [&](int c) { return static_cast<std::uint8_t>(channels[c] + 0.5F); };
      picture(window_.x + left + x, window_.y + top + y) = {level(0), level(1), level(2)};
    });
    return true;
  }

  /// Pixels beside a hole.
  struct Rim {
    int plane = 0, foreground = 0;
  };

  PlaneColors plane_colors_;
  Rect window_;  ///< in the picture
  Image<state::Code> states_;
  std::array<Rect, most_labels> boxes_;              ///< of the holes of each label, in the window
  std::array<SmoothFilling, label_count> fillings_;  ///< by label
  std::vector<std::uint32_t> bits_;
  ConnectedRuns parts_;
  std::vector<Rim> rims_;
};

const bool registered =
    Registry<Inpainter>::add("surfaces", [] { return std::make_unique<SurfaceInpainting>(); });

}  // namespace
}  // namespace diminish
