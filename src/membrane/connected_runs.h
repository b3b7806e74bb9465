#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace diminish {

/// The 4-connected parts of a set of pixels, found by uniting the runs of neighbouring rows.
class ConnectedRuns {
 public:
  /// bits: 32 pixels a word, the lowest bit first; `words_per_row` apart, `words` of them used.
  void find(const std::uint32_t* bits, std::ptrdiff_t words_per_row, int words, int height);

  /// Columns [first, last) of a row.
  struct Run {
    int first, last;
    std::size_t part;  ///< below `part_limit`, with gaps

    /// Those of a word's 32 pixels that lie in the run; the run must reach into the word.
    std::uint32_t bits(int word) const {
      const int from = std::max(first - 32 * word, 0);
      const int to = std::min(last - 32 * word, 32);
      return (to == 32 ? ~0U : (1U << to) - 1) & ~((1U << from) - 1);
    }
  };
  std::span<const Run> row(int y) const {
    const std::size_t begin = row_begin_[static_cast<std::size_t>(y)];
    return {runs_.data() + begin, row_begin_[static_cast<std::size_t>(y) + 1] - begin};
  }
  std::size_t part_limit() const { return runs_.size(); }

 private:
  std::size_t root(std::size_t run);

  std::vector<Run> runs_;
  std::vector<std::size_t> row_begin_;
};

}  // namespace diminish
