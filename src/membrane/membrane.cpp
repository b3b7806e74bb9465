#include "diminish/membrane.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <stdexcept>
#include <string>

#include "core/bounding_box.h"
#include "core/channels.h"
#include "core/neighbours.h"
#include "core/rows.h"
#include "membrane/picture.h"
#include "membrane/solver.h"

namespace diminish {
namespace {

// Of the last multigrid correction; what is left of the error is smaller.
constexpr float cloning_tolerance_levels = 0.2F;
constexpr float filling_tolerance_levels = 1.F;

using ConstView = Membrane::ConstView;
constexpr int channels = MembraneSolver::channels;
constexpr std::uint8_t most_layers = MembraneSolver::fixed - 1;

struct Difference {
  float value[channels];

  Difference(const std::uint8_t* a, const std::uint8_t* b)
      : value{static_cast<float>(a[0] - b[0]), static_cast<float>(a[1] - b[1]),
              static_cast<float>(a[2] - b[2])} {}
};

std::string describe(int width, int height, const std::string& count) {
  return std::to_string(width) + "x" + std::to_string(height) + ", channels: " + count;
}

/// Throws unless the view has this size, and from `fewest` to `most` channels.
void expect(const char* name, const ConstView& view, const ConstView& other, int fewest, int most) {
  if (view.width == other.width && view.height == other.height && view.channels >= fewest &&
      view.channels <= most) {
    return;
  }
  const std::string count =
      std::to_string(fewest) + (most > fewest ? " or " + std::to_string(most) : "");
  throw std::invalid_argument(std::string(name) + ": expected " +
                              describe(other.width, other.height, count) + "; got " +
                              describe(view.width, view.height, std::to_string(view.channels)));
}

/// The mask's bounding box and what is beside it.
Rect window_around(const ConstView& mask) {
  const Rect bounds{0, 0, mask.width, mask.height};
  return intersect(grow(bounding_box(mask.data, mask.stride, bounds), 1), bounds);
}

template <class Byte>
Membrane::BasicView<Byte> part(const Membrane::BasicView<Byte>& view, const Rect& rect) {
  return view.part(rect.x, rect.y, rect.width, rect.height);
}

/// Returns whether several layers may meet inside the mask.
bool set_keys(const ConstView& mask, const ConstView& layers, MembraneSolver& solver) {
  std::atomic<unsigned> found_anywhere = 0;
  for_rows(mask.height, [&](Rows rows) {
    unsigned found = 0;
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* mask_row = mask.row(y);
      const std::uint8_t* layer_row = layers.row(y);
      std::uint8_t* keys = solver.keys(y);
      for (int x = 0; x < mask.width; ++x) {
        const std::uint8_t inside = std::min(layer_row[x], most_layers);
        const std::uint8_t outside = layer_row[x] != 0 ? MembraneSolver::fixed : 0;
        keys[x] = mask_row[x] != 0 ? inside : outside;
        found |= mask_row[x] != 0 ? inside : 0U;
      }
    }
    found_anywhere |= found;
  });
  return !std::has_single_bit(found_anywhere.load());
}

void set_keys(const ConstView& mask, MembraneSolver& solver) {
  for_rows(mask.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* mask_row = mask.row(y);
      std::uint8_t* keys = solver.keys(y);
      for (int x = 0; x < mask.width; ++x) {
        keys[x] = mask_row[x] != 0 ? std::uint8_t{1} : MembraneSolver::fixed;
      }
    }
  });
}

/// Across the seam between two layers the source's gradient says nothing; the result's is zero.
void even_out_seams(const ConstView& source, const ConstView& layers, MembraneSolver& solver) {
  const Rect bounds{0, 0, source.width, source.height};
  solver.for_each_irregular([&](int x, int y) {
    for (const auto& [dx, dy] : neighbour_offsets) {
      if (!bounds.contains(x + dx, y + dy)) continue;
      const std::uint8_t other = *layers.pixel(x + dx, y + dy);
      if (other == 0 || other == *layers.pixel(x, y)) continue;
      const Difference difference(source.pixel(x + dx, y + dy), source.pixel(x, y));
      solver.add_source(x, y, difference.value);
    }
  });
}

/// Sets target - source where they meet. Returns the mean.
Eigen::Array3f set_differences(const ConstView& target, const ConstView& source,
                               MembraneSolver& solver) {
  double sum[channels] = {};
  std::size_t count = 0;
  solver.for_each_fixed([&](int x, int y) {
    const Difference difference(target.pixel(x, y), source.pixel(x, y));
    solver.set_fixed(x, y, difference.value);
    for (int c = 0; c < channels; ++c) sum[c] += static_cast<double>(difference.value[c]);
    ++count;
  });
  Eigen::Array3f mean = Eigen::Array3f::Zero();
  for (int c = 0; c < channels && count > 0; ++c) {
    mean[c] = static_cast<float>(sum[c] / static_cast<double>(count));
  }
  return mean;
}

void correct_loose_parts(const ConstView& source, const Eigen::Array3f& correction,
                         MembraneSolver& solver, const Membrane::View& picture) {
  for (const LooseRun& run : solver.take_out_loose_parts()) {
    for (int x = run.first; x < run.last; ++x) {
      const std::uint8_t* from = source.pixel(x, run.y);
      const Bgr color = to_color(to_channels({from[0], from[1], from[2]}) + correction);
      std::uint8_t* to = picture.pixel(x, run.y);
      to[0] = color.b;
      to[1] = color.g;
      to[2] = color.r;
    }
  }
}

}  // namespace

Membrane::Membrane() : solver_(std::make_unique<MembraneSolver>()) {}
Membrane::~Membrane() = default;
Membrane::Membrane(Membrane&&) noexcept = default;
Membrane& Membrane::operator=(Membrane&&) noexcept = default;

// In terms of the correction x = result - source, which is smooth: its Laplacian is 0, target -
// source is its value beside the mask (Dirichlet), and its borders to pixels that show nothing are
// free (Neumann).
void Membrane::clone(const Cloning& cloning, View picture) {
  const bool has_layers = cloning.layers.data != nullptr;
  expect("picture", picture, cloning.mask, 3, 3);
  expect("target", cloning.target, cloning.mask, 3, 4);
  expect("source", cloning.source, cloning.mask, 3, 4);
  expect("mask", cloning.mask, cloning.mask, 1, 1);
  if (has_layers) expect("layers", cloning.layers, cloning.mask, 1, 1);

  const Rect window = window_around(cloning.mask);
  if (window.empty()) return;
  const ConstView target = part(cloning.target, window);
  const ConstView source = part(cloning.source, window);
  const ConstView mask = part(cloning.mask, window);
  const ConstView layers = has_layers ? part(cloning.layers, window) : ConstView{};
  picture = part(picture, window);

  MembraneSolver& solver = *solver_;
  solver.begin(window.width, window.height);
  bool has_seams = false;
  if (has_layers) {
    has_seams = set_keys(mask, layers, solver);
  } else {
    set_keys(mask, solver);
  }
  solver.connect();
  if (solver.size() == 0) return;
  const Eigen::Array3f mean = set_differences(target, source, solver);
  correct_loose_parts(source, mean, solver, picture);
  if (has_seams) even_out_seams(source, layers, solver);
  solver.solve(cloning_tolerance_levels);
  add_solution(solver, source, picture);
}

bool Membrane::fill(ConstView mask, View picture) {
  expect("picture", picture, mask, 3, 3);
  expect("mask", mask, mask, 1, 1);
  const Rect window = window_around(mask);
  if (window.empty()) return true;
  mask = part(mask, window);
  picture = part(picture, window);

  MembraneSolver& solver = *solver_;
  solver.begin(window.width, window.height);
  set_keys(mask, solver);
  solver.connect();
  bool anything_known = false;
  solver.for_each_fixed([&](int x, int y) {
    const std::uint8_t* color = picture.pixel(x, y);
    solver.set_fixed(
        x, y,
        {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2])});
    anything_known = true;
  });
  if (!anything_known) return false;
  solver.solve(filling_tolerance_levels);
  write_solution(solver, picture);
  return true;
}

}  // namespace diminish
