#include <algorithm>
#include <cmath>

#include "membrane/solver.h"

namespace diminish {
namespace {

/// More pixels are left to multigrid.
constexpr int most_pixels = 64;
constexpr int most_sweeps = 100;
/// What a sweep may change when no further one follows, as a share of the tolerance.
constexpr float least_change = 0.05F;

}  // namespace

void MembraneSolver::relax_small_parts(float tolerance) {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const ConnectedRegions::Region& part = parts_.regions()[i];
    if (!held_[i] || part.pixels > most_pixels) continue;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      float change = 0;
      parts_.for_each_run(part, [&](const ConnectedRegions::Run& run) {
        for (int x = run.first; x < run.last; ++x) {
          change = std::max(change, relax_pixel(x, run.y));
        }
      });
      if (change < least_change * tolerance) break;
    }
  }
}

float MembraneSolver::relax_pixel(int x, int y) {
  MembraneLevel& finest = levels_.front();
  const std::uint8_t* const key = keys(y) + x;
  const bool counts[] = {key[-1] != 0, key[1] != 0, key[-keys_per_row_] != 0,
                         key[keys_per_row_] != 0};
  float change = 0;
  for (int c = 0; c < channels; ++c) {
    float sum = finest.has_sources ? finest.right_side.data()[finest.cell_at(x, y, c)] : 0;
    float neighbours = 0;
    const auto add = [&](bool is_there, int column, int row) {
      if (!is_there) return;
      sum += finest.x.data()[finest.cell_at(column, row, c)];
      neighbours += 1;
    };
    add(counts[0], x - 1, y);
    add(counts[1], x + 1, y);
    add(counts[2], x, y - 1);
    add(counts[3], x, y + 1);
    if (neighbours == 0) continue;
    float& value = finest.x.data()[finest.cell_at(x, y, c)];
    change = std::max(change, std::abs(sum / neighbours - value));
    value = sum / neighbours;
  }
  return change;
}

}  // namespace diminish
