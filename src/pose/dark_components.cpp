#include "pose/dark_components.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace diminish {
namespace {

/// Half the side of the square around a pixel. Small, so that a marker does not grow together with
/// the shadow around its margin.
constexpr int radius = 2;
constexpr int side = 2 * radius + 1;
/// A dark pixel's brightness times this is less than the sum of the square: 7 % below its mean.
constexpr int scale = 27;
static_assert(side == 5 && scale * (255 + 2) < 65536, "the sums below are written out, in 16 bits");
/// In levels: what noise does not reach in a dark picture.
constexpr int min_contrast = 2;

}  // namespace

void DarkComponents::find(const Image<std::uint8_t>& small) {
  threshold(small);
  connect();
}

void DarkComponents::threshold(const Image<std::uint8_t>& small) {
  const int width = small.width();
  const int height = small.height();
  runs_.clear();
  row_begin_.assign(1, 0);
  column_sums_.resize(static_cast<std::size_t>(width));
  // A margin of light pixels, so that every run ends inside.
  dark_.assign(static_cast<std::size_t>(width) + sizeof(std::uint64_t), 0);
  std::uint16_t* sums = column_sums_.data();
  for (int y = 0; y < height; ++y) {
    if (y >= radius && y + radius < height && width > 2 * radius) {
      const std::uint8_t* rows[side];
      for (int i = 0; i < side; ++i) rows[i] = small.row(y - radius + i);
      for (int x = 0; x < width; ++x) {
        sums[x] = static_cast<std::uint16_t>(rows[0][x] + rows[1][x] + rows[2][x] + rows[3][x] +
                                             rows[4][x]);
      }
      const std::uint8_t* row = small.row(y);
      std::uint8_t* dark = dark_.data();
      for (int x = radius; x < width - radius; ++x) {
        const auto around = static_cast<std::uint16_t>(sums[x - 2] + sums[x - 1] + sums[x] +
                                                       sums[x + 1] + sums[x + 2]);
        const auto own = static_cast<std::uint16_t>(scale * row[x] + scale * min_contrast);
        dark[x] = own < around ? 255 : 0;
      }
      collect_runs(y, width);
    }
    row_begin_.push_back(static_cast<int>(runs_.size()));
  }
}

void DarkComponents::collect_runs(int y, int width) {
  // Eight pixels at a time: where the first one is that is dark (or light, if flipped).
  const auto next = [&](int x, std::uint64_t flip) {
    while (x < width) {
      std::uint64_t word;
      std::memcpy(&word, dark_.data() + x, sizeof(word));
      word ^= flip;
      if (word != 0) return std::min(width, x + std::countr_zero(word) / 8);
      x += static_cast<int>(sizeof(word));
    }
    return width;
  };
  for (int x = 0; (x = next(x, 0)) < width;) {
    const int first = x;
    x = next(x, ~std::uint64_t{0});
    runs_.push_back({y, first, x, static_cast<int>(runs_.size()), -1});
  }
}

void DarkComponents::connect() {
  const int rows = static_cast<int>(row_begin_.size()) - 1;
  for (int y = 1; y < rows; ++y) {
    int above = row_begin_[static_cast<std::size_t>(y) - 1];
    const int row = row_begin_[static_cast<std::size_t>(y)];
    const int end = row_begin_[static_cast<std::size_t>(y) + 1];
    for (int i = row; i < end; ++i) {
      Run& run = runs_[static_cast<std::size_t>(i)];
      while (above < row && runs_[static_cast<std::size_t>(above)].last <= run.first) ++above;
      for (int other = above;
           other < row && runs_[static_cast<std::size_t>(other)].first < run.last; ++other) {
        const int a = root(i);
        const int b = root(other);
        runs_[static_cast<std::size_t>(std::max(a, b))].component = std::min(a, b);
      }
    }
  }
  // Roots come before the runs below them, so that one pass names and chains all.
  components_.clear();
  last_run_.clear();
  for (int i = 0; i < static_cast<int>(runs_.size()); ++i) {
    Run& run = runs_[static_cast<std::size_t>(i)];
    const int length = run.last - run.first;
    if (run.component == i) {
      run.component = static_cast<int>(components_.size());
      components_.push_back({{run.first, run.y, length, 1}, i, length});
      last_run_.push_back(i);
      continue;
    }
    run.component = runs_[static_cast<std::size_t>(run.component)].component;
    Component& component = components_[static_cast<std::size_t>(run.component)];
    runs_[static_cast<std::size_t>(last_run_[static_cast<std::size_t>(run.component)])].next = i;
    last_run_[static_cast<std::size_t>(run.component)] = i;
    const int right = std::max(component.box.right(), run.last);
    component.box.x = std::min(component.box.x, run.first);
    component.box.width = right - component.box.x;
    component.box.height = run.y + 1 - component.box.y;
    component.pixels += length;
  }
}

int DarkComponents::root(int run) {
  while (runs_[static_cast<std::size_t>(run)].component != run) {
    int& parent = runs_[static_cast<std::size_t>(run)].component;
    parent = runs_[static_cast<std::size_t>(parent)].component;
    run = parent;
  }
  return run;
}

}  // namespace diminish
