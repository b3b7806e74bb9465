#include "membrane/connected_runs.h"

#include <algorithm>
#include <bit>

namespace diminish {

void ConnectedRuns::find(const std::uint32_t* bits, std::ptrdiff_t words_per_row, int words,
                         int height) {
  runs_.clear();
  row_begin_.assign(1, 0);
  for (int y = 0; y < height; ++y, bits += words_per_row) {
    std::size_t above = y > 0 ? row_begin_[static_cast<std::size_t>(y) - 1] : 0;
    const std::size_t row = runs_.size();
    const auto add = [&](int first, int last) {
      const std::size_t run = runs_.size();
      runs_.push_back({first, last, run});
      while (above < row && runs_[above].last <= first) ++above;
      for (std::size_t other = above; other < row && runs_[other].first < last; ++other) {
        const std::size_t a = root(run);
        const std::size_t b = root(other);
        runs_[std::max(a, b)].part = std::min(a, b);
      }
    };
    int start = -1;
    for (int word = 0; word < words; ++word) {
      const unsigned value = bits[word];
      if (value == (start < 0 ? 0U : ~0U)) continue;
      for (int bit = 0; bit < 32;) {
        const unsigned rest = (start < 0 ? value : ~value) >> bit;
        if (rest == 0) break;
        bit += std::countr_zero(rest);
        if (start < 0) {
          start = word * 32 + bit;
        } else {
          add(start, word * 32 + bit);
          start = -1;
        }
      }
    }
    if (start >= 0) add(start, words * 32);
    row_begin_.push_back(runs_.size());
  }
  for (std::size_t run = 0; run < runs_.size(); ++run) runs_[run].part = root(run);
}

std::size_t ConnectedRuns::root(std::size_t run) {
  while (runs_[run].part != run) {
    runs_[run].part = runs_[runs_[run].part].part;
    run = runs_[run].part;
  }
  return run;
}

}  // namespace diminish
