#include <algorithm>
#include <cmath>

#include "core/neighbours.h"
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
  float change = 0;
  for (int c = 0; c < channels; ++c) {
    float sum = finest.has_sources ? finest.right_side.data()[finest.cell_at(x, y, c)] : 0;
    float neighbours = 0;
    for (const auto& [dx, dy] : neighbour_offsets) {
      if (keys(y + dy)[x + dx] == 0) continue;
      sum += finest.x.data()[finest.cell_at(x + dx, y + dy, c)];
      neighbours += 1;
    }
    if (neighbours == 0) continue;
    float& value = finest.x.data()[finest.cell_at(x, y, c)];
    change = std::max(change, std::abs(sum / neighbours - value));
    value = sum / neighbours;
  }
  return change;
}

}  // namespace diminish
