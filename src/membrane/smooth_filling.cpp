#include "membrane/smooth_filling.h"

#include <algorithm>
#include <utility>

#include "core/rows.h"
#include "core/runs.h"

namespace diminish {
namespace {

/// Open cells; fewer are relaxed sooner by one thread.
constexpr std::size_t fewest_shared = 8192;
/// A multiple of 32 (band_height), so wide that what is left out at its two ends does not meet.
constexpr int least_shared_rows = 32;
static_assert(least_shared_rows >= 2 * SmoothFilling::most_half_sweeps);

/// The cells that hold the rectangle's.
Rect coarser_box(const Rect& box) {
  const int x = box.x >> 1;
  const int y = box.y >> 1;
  return {x, y, ((box.right() + 1) >> 1) - x, ((box.bottom() + 1) >> 1) - y};
}

// Of rows, by value, so that the loops are vectorised.

using Kind = SmoothFilling::Kind;
constexpr Kind open = SmoothFilling::open;

/// Which cells are not open, but beside one that is.
void find_beside(const Kind* above, const Kind* here, const Kind* below, int width, Kind* beside) {
  beside[0] = here[1] & open;
  beside[width - 1] = here[width - 2] & open;
  for (int x = 1; x < width - 1; ++x) {
    beside[x] = (above[x] | below[x] | here[x - 1] | here[x + 1]) & ~here[x] & open;
  }
}
/// What is known elsewhere does not matter.
void leave_out_others(const Kind* kinds, const Kind* beside, int width, Kind* left) {
  for (int x = 0; x < width; ++x) left[x] = kinds[x] & static_cast<Kind>(open | (beside[x] << 1));
}
void find_greater(const Kind* a, const Kind* b, int count, Kind* greater) {
  for (int x = 0; x < count; ++x) greater[x] = std::max(a[x], b[x]);
}
void find_greater_of_pairs(const Kind* pairs, int count, Kind* greater) {
  for (std::ptrdiff_t x = 0; x < count; ++x) greater[x] = std::max(pairs[2 * x], pairs[2 * x + 1]);
}

}  // namespace

void SmoothFilling::Grid::begin(const Rect& open_box) {
  box = open_box;
  kinds.resize(box.width + 2, box.height + 2);
  colors.resize(box.width + 2, box.height + 2);
  known.clear();
}

void SmoothFilling::Grid::find_open() {
  runs.clear();
  row_begin.clear();
  for (int y = 0; y < box.height; ++y) {
    row_begin.push_back(runs.size());
    const Kind* const row_kinds = kinds.row(y + 1) + 1;
    diminish::for_each_run(row_kinds, 0, box.width, open, [&](int first, int last) {
      runs.push_back({box.x + first, box.x + last});
    });
  }
  row_begin.push_back(runs.size());
}

/// For for_rows: as many as are worth a task.
int SmoothFilling::Grid::shared_rows() const {
  std::size_t cells = 0;
  for (const Run run : runs) cells += static_cast<std::size_t>(run.last - run.first);
  return cells < fewest_shared ? box.height : least_shared_rows;
}

/// What is beside an open cell is listed if it is known, else has no colour; all other known cells
/// become absent.
void SmoothFilling::Grid::find_known() {
  const int width = kinds.width();
  const int height = kinds.height();
  next_kinds.resize(width, height);
  const auto find_in_row = [&](int y, Kind* beside, std::vector<Place>& found) {
    // In the rim, its own row does for the one beyond: neither holds an open cell.
    const Kind* const above = kinds.row(std::max(y - 1, 0));
    const Kind* const below = kinds.row(std::min(y + 1, height - 1));
    Kind* const next = next_kinds.row(y);
    find_beside(above, kinds.row(y), below, width, beside);
    leave_out_others(kinds.row(y), beside, width, next);
    Color* const row_colors = colors.row(y);
    for_each_set(beside, width, [&](int x) {
      if (next[x] == SmoothFilling::known) {
        found.push_back({box.x - 1 + x, box.y - 1 + y});
      } else {
        row_colors[x].setZero();
      }
    });
  };
  for (auto& found : known_in_band) found.clear();
  for_rows(height, [&](Rows rows) {
    std::vector<Kind>& beside = row_in_band[rows.band];
    beside.resize(static_cast<std::size_t>(width));
    for (int y = rows.first; y < rows.last; ++y) {
      find_in_row(y, beside.data(), known_in_band[rows.band]);
    }
  });
  std::swap(kinds, next_kinds);
  for (const auto& found : known_in_band) known.insert(known.end(), found.begin(), found.end());
}

void SmoothFilling::Grid::coarsen(const Grid& fine) {
  begin(coarser_box(fine.box));
  // The fine grid's place in this one's, in fine cells.
  const int left = fine.box.x - 1 - 2 * (box.x - 1);
  const int top = fine.box.y - 1 - 2 * (box.y - 1);
  const int last = fine.kinds.height() - 1;
  const int fine_width = fine.kinds.width();
  const int width = kinds.width();
  for_rows(kinds.height(), [&](Rows rows) {
    std::vector<Kind>& row = row_in_band[rows.band];
    row.assign(2 * static_cast<std::size_t>(width), absent);
    Kind* const both = row.data() + left;
    const Kind* const pairs = row.data();
    for (int y = rows.first; y < rows.last; ++y) {
      std::fill_n(colors.row(y), width, Color::Zero());
      const int first_row = 2 * y - top;
      Kind* const here = kinds.row(y);
      if (first_row + 1 < 0 || first_row > last) {
        std::fill_n(here, width, absent);
        continue;
      }
      const Kind* const upper = fine.kinds.row(std::max(first_row, 0));
      const Kind* const lower = fine.kinds.row(std::min(first_row + 1, last));
      find_greater(upper, lower, fine_width, both);
      find_greater_of_pairs(pairs, width, here);
    }
  });
  find_open();
  for (const Place place : fine.known) {
    Color& color = color_row(place.y >> 1)[place.x >> 1];
    if (color[3] == 0) known.push_back({place.x >> 1, place.y >> 1});
    color += fine.color_row(place.y)[place.x];
  }
  for (const Place place : known) {
    Color& color = color_row(place.y)[place.x];
    color /= Color::Constant(color[3]);
  }
}

void SmoothFilling::Grid::interpolate_row(const Grid& coarse, int y) {
  const std::span<const Run> own = runs_of(y);
  if (own.empty()) return;
  filling_rows::interpolate(own, y, coarse.color_row(y >> 1),
                            coarse.color_row((y >> 1) + (y % 2 == 0 ? -1 : 1)), color_row(y));
}

void SmoothFilling::Grid::relax_row(int y, int parity, float factor) {
  const std::span<const Run> own = runs_of(y);
  if (own.empty()) return;
  filling_rows::relax(own, y, parity, factor, color_row(y - 1), color_row(y + 1), color_row(y));
}

/// All sweeps go over a band of rows together, each a row behind the one before it: what they read
/// is in the cache. Where a band meets the next, each sweep stops a row before the last one did: it
/// lacks what is beyond. Once all bands are done, what was left out there follows. So every cell
/// becomes what it would become without bands.
void SmoothFilling::Grid::refine(const Grid& coarse, const Relaxation& relaxation) {
  const int half_sweeps = relaxation.half_sweeps;
  float factors[most_half_sweeps];
  for (int k = 0; k < half_sweeps; ++k) factors[k] = relaxation.factor(k);
  const int least = shared_rows();
  for_rows(
      box.height,
      [&](Rows rows) {
        const bool meets_above = rows.first > 0;
        const bool meets_below = rows.last < box.height;
        for (int at = rows.first; at < rows.last + half_sweeps; ++at) {
          if (at < rows.last) interpolate_row(coarse, box.y + at);
          for (int k = 0; k < half_sweeps; ++k) {
            const int relaxed = at - 1 - k;
            if (relaxed < rows.first + (meets_above ? 1 + k : 0) ||
                relaxed >= rows.last - (meets_below ? 1 + k : 0)) {
              continue;
            }
            relax_row(box.y + relaxed, k % 2, factors[k]);
          }
        }
      },
      least);
  const int height = band_height(box.height, least);
  for (int border = height; border < box.height; border += height) {
    for (int k = 0; k < half_sweeps; ++k) {
      for (int at = border - 1 - k; at < border + 1 + k; ++at) {
        relax_row(box.y + at, k % 2, factors[k]);
      }
    }
  }
}

float SmoothFilling::Relaxation::factor(int k) const {
  const float square = spectral_radius * spectral_radius;
  float factor = 1;
  for (int i = 0; i < k; ++i) factor = 1 / (1 - square * factor / (i == 0 ? 2 : 4));
  return factor;
}

Image<SmoothFilling::Kind>& SmoothFilling::begin(const Rect& box) {
  grids_.front().begin(box);
  return grids_.front().kinds;
}

void SmoothFilling::solve() {
  std::size_t count = 1;
  while (!grids_[count - 1].runs.empty()) {
    if (grids_.size() == count) grids_.emplace_back();
    grids_[count].coarsen(grids_[count - 1]);
    ++count;
  }
  for (std::size_t l = count - 1; l-- > 0;) {
    grids_[l].refine(grids_[l + 1], l == 0 ? finest : coarser);
  }
}

}  // namespace diminish
