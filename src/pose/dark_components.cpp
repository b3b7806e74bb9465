#include "pose/dark_components.h"

#include <algorithm>

namespace diminish {

void decimate(const Image<Bgr>& image, Image<std::uint8_t>& small) {
  small.resize(image.width() / decimation, image.height() / decimation);
  for (int y = 0; y < small.height(); ++y) {
    // Two of the four rows: half the memory, and noise is no worry here.
    const std::uint8_t* upper =
        reinterpret_cast<const std::uint8_t*>(image.row(decimation * y + 1));
    const std::uint8_t* lower =
        reinterpret_cast<const std::uint8_t*>(image.row(decimation * y + 2));
    std::uint8_t* to = small.row(y);
    for (int x = 0; x < small.width(); ++x) {
      // The green channel of four pixels; the others add little.
      const int at = 3 * decimation * x + 1;
      const int sum = upper[at] + upper[at + 3] + upper[at + 6] + upper[at + 9] + lower[at] +
                      lower[at + 3] + lower[at + 6] + lower[at + 9];
      to[x] = static_cast<std::uint8_t>((sum + 4) >> 3);
    }
  }
}

void DarkComponents::find(const Image<std::uint8_t>& small, int radius, int contrast) {
  threshold(small, radius, contrast);
  connect();
}

void DarkComponents::threshold(const Image<std::uint8_t>& small, int radius, int contrast) {
  const int width = small.width();
  const int height = small.height();
  runs_.clear();
  row_begin_.assign(1, 0);
  column_sums_.assign(static_cast<std::size_t>(width), 0);
  prefix_.resize(static_cast<std::size_t>(width) + 1);
  const auto add_row = [&](int y) {
    const std::uint8_t* row = small.row(y);
    for (int x = 0; x < width; ++x) {
      column_sums_[static_cast<std::size_t>(x)] =
          static_cast<std::uint16_t>(column_sums_[static_cast<std::size_t>(x)] + row[x]);
    }
  };
  const auto remove_row = [&](int y) {
    const std::uint8_t* row = small.row(y);
    for (int x = 0; x < width; ++x) {
      column_sums_[static_cast<std::size_t>(x)] =
          static_cast<std::uint16_t>(column_sums_[static_cast<std::size_t>(x)] - row[x]);
    }
  };
  for (int y = 0; y < std::min(radius, height); ++y) add_row(y);
  for (int y = 0; y < height; ++y) {
    if (y + radius < height) add_row(y + radius);
    if (y - radius - 1 >= 0) remove_row(y - radius - 1);
    const int rows = std::min(y + radius, height - 1) - std::max(y - radius, 0) + 1;
    std::uint32_t sum = 0;
    for (int x = 0; x < width; ++x) {
      prefix_[static_cast<std::size_t>(x)] = sum;
      sum += column_sums_[static_cast<std::size_t>(x)];
    }
    prefix_[static_cast<std::size_t>(width)] = sum;
    const std::uint8_t* row = small.row(y);
    int start = -1;
    for (int x = 0; x < width; ++x) {
      const int left = std::max(x - radius, 0);
      const int right = std::min(x + radius + 1, width);
      const auto around = static_cast<int>(prefix_[static_cast<std::size_t>(right)] -
                                           prefix_[static_cast<std::size_t>(left)]);
      const bool dark = (row[x] + contrast) * (rows * (right - left)) < around;
      if (dark && start < 0) start = x;
      if (!dark && start >= 0) {
        runs_.push_back({y, start, x, static_cast<int>(runs_.size()), -1});
        start = -1;
      }
    }
    if (start >= 0) runs_.push_back({y, start, width, static_cast<int>(runs_.size()), -1});
    row_begin_.push_back(static_cast<int>(runs_.size()));
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
      while (above < row && runs_[static_cast<std::size_t>(above)].last < run.first) ++above;
      for (int other = above; other < row && runs_[static_cast<std::size_t>(other)].first <= run.last;
           ++other) {
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
