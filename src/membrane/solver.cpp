#include "membrane/solver.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/rows.h"
#include "membrane/kernels.h"

namespace diminish {
namespace {

using Block = MembraneLevel::Block;
constexpr int tile_width = MembraneLevel::tile_width;

constexpr int max_cycles = 12;
/// On the level that MembraneCoarsest corrects.
constexpr int coarsest_sweeps = 2;
/// Multiplications that its factorization may take.
constexpr double most_work = 2e6;

/// Those of a word's pixels that lie in the run, which must reach into the word.
std::uint32_t bits_of(const ConnectedRegions::Run& run, int word) {
  const int from = std::max(run.first - 32 * word, 0);
  const int to = std::min(run.last - 32 * word, 32);
  return (to == 32 ? ~0U : (1U << to) - 1) & ~((1U << from) - 1);
}

/// The squared error after a cycle, in terms of its squared change, if further ones reduce it at
/// the rate at which it was reduced before; at least as is usual, and as said of the first cycle.
double left_of_error(double change_before, double change) {
  constexpr double usual_rate = 0.4;
  const double rate = change_before > 0
                          ? std::clamp(std::sqrt(change / change_before), usual_rate, 0.95)
                          : usual_rate;
  return std::pow(rate / (1 - rate), 2);
}

void relax(const MembraneLevel& level, const float* right_side, float* values, bool from_zero) {
  for_rows(level.height,
           [&](Rows rows) { membrane::relax(level, right_side, values, from_zero, rows); });
  const int height = band_height(level.height);
  for (int row = height; row < level.height; row += height) {
    membrane::relax_seam(level, right_side, values, from_zero, row);
  }
}
double prolong(const MembraneLevel& coarse, const float* coarse_values, bool add,
               const MembraneLevel& fine, float* values) {
  return sum_over_rows(fine.rows(), [&](Rows rows) {
    return membrane::prolong(coarse, coarse_values, add, rows, fine, values);
  });
}
double restrict_residual(const MembraneLevel& fine, const float* right_side, const float* values,
                         MembraneLevel& coarse) {
  const double squares = sum_over_rows(coarse.rows(), [&](Rows rows) {
    return membrane::restrict_residual(fine, right_side, values, rows, coarse);
  });
  membrane::finish_residual(fine, values, coarse);
  return squares;
}
void invert_diagonal(MembraneLevel& level) {
  for_rows(level.rows(), [&](Rows rows) { membrane::invert_diagonal(rows, level); });
}

/// Sets the solution to 0 where it is not given: another frame's may be left there.
void start_from_zero(MembraneLevel& level) {
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      if (level.inverse.data()[level.cell_at(x, y)] < 0) continue;
      for (int c = 0; c < MembraneLevel::channels; ++c) {
        level.x.data()[level.cell_at(x, y, c)] = 0;
      }
    }
  }
}

int half(int cells) {
  return (cells + 1) / 2;
}

}  // namespace

void MembraneSolver::begin(int width, int height) {
  width_ = width;
  height_ = height;
  tile_columns_ = (width + tile_width - 1) / tile_width;
  keys_per_row_ = std::ptrdiff_t{tile_columns_ + 2} * tile_width;
  words_per_row_ = tile_columns_ + 2;
  keys_.resize(static_cast<std::size_t>((height + 2) * keys_per_row_));
  cells_.resize(
      static_cast<std::size_t>((height + 2 + MembraneLevel::tile_height) * words_per_row_));
  fixed_.resize(cells_.size());
  irregular_.resize(cells_.size());
  sources_.clear();
  fixed_values_.clear();
  held_.clear();
  std::fill_n(keys_.begin(), keys_per_row_, std::uint8_t{0});
  std::fill_n(keys_.end() - keys_per_row_, keys_per_row_, std::uint8_t{0});
  for (int y = 0; y < height; ++y) {
    keys(y)[-1] = 0;
    std::fill(keys(y) + width, keys(y) + std::ptrdiff_t{tile_columns_} * tile_width + 1,
              std::uint8_t{0});
  }
}

void MembraneSolver::connect() {
  for (auto* words : {&cells_, &fixed_, &irregular_}) {
    std::fill_n(words->begin(), words_per_row_, std::uint32_t{0});
    std::fill(words->begin() + (height_ + 1) * words_per_row_, words->end(), std::uint32_t{0});
  }
  size_ = sum_over_rows(height_, [&](Rows rows) {
    std::size_t count = 0;
    for (int y = rows.first; y < rows.last; ++y) {
      const std::ptrdiff_t row = word_index(y);
      for (auto* words : {&cells_, &fixed_, &irregular_}) {
        (*words)[static_cast<std::size_t>(row - 1)] = 0;
        (*words)[static_cast<std::size_t>(row + tile_columns_)] = 0;
      }
      membrane::classify_row(keys(y), keys_per_row_, tile_columns_, cells_.data() + row,
                             fixed_.data() + row, irregular_.data() + row);
      for (int word = 0; word < tile_columns_; ++word) {
        count +=
            static_cast<std::size_t>(std::popcount(cells_[static_cast<std::size_t>(row + word)]));
      }
    }
    return count;
  });
}

void MembraneSolver::set_fixed(int x, int y, const Values& value) {
  fixed_values_.push_back({x, y, {value[0], value[1], value[2]}});
}
void MembraneSolver::add_source(int x, int y, const Values& value) {
  sources_.push_back({x, y, {value[0], value[1], value[2]}});
}

const std::vector<LooseRun>& MembraneSolver::take_out_loose_parts() {
  using Run = ConnectedRegions::Run;
  parts_.begin();
  for (int y = 0; y < height_; ++y) {
    for_each_run(cells_.data() + word_index(y), tile_columns_,
                 [&](int first, int last) { parts_.add(y, first, last); });
  }
  parts_.connect(Connectivity::four);
  held_.assign(parts_.regions().size(), false);
  for (const Run& run : parts_.runs()) {
    const std::uint32_t* row = fixed_.data() + word_index(run.y);
    const std::uint32_t* above = row - words_per_row_;
    const std::uint32_t* below = row + words_per_row_;
    bool held = held_[run.region];
    for (int word = run.first / 32; !held && word <= (run.last - 1) / 32; ++word) {
      const std::uint32_t beside = row[word] << 1 | row[word] >> 1 | row[word - 1] >> 31 |
                                   row[word + 1] << 31 | above[word] | below[word];
      held = (beside & bits_of(run, word)) != 0;
    }
    held_[run.region] = held;
  }
  loose_.clear();
  for (const Run& run : parts_.runs()) {
    if (held_[run.region]) continue;
    loose_.push_back({run.y, run.first, run.last});
    for (int word = run.first / 32; word <= (run.last - 1) / 32; ++word) {
      const auto at = static_cast<std::size_t>(word_index(run.y) + word);
      const std::uint32_t bits = bits_of(run, word);
      size_ -= static_cast<std::size_t>(std::popcount(cells_[at] & bits));
      cells_[at] &= ~bits;
      irregular_[at] &= ~bits;
    }
    std::fill(keys(run.y) + run.first, keys(run.y) + run.last, std::uint8_t{0});
  }
  return loose_;
}

void MembraneSolver::build() {
  level_count_ = 1;
  for (int w = width_, h = height_; MembraneCoarsest::work(w, h) > most_work; ++level_count_) {
    w = half(w);
    h = half(h);
  }
  if (levels_.size() < level_count_) levels_.resize(level_count_);

  MembraneLevel& finest = levels_.front();
  finest.begin(width_, height_);
  for (int y = 0; y < height_; ++y) {
    const std::uint32_t* cells = cells_.data() + word_index(y);
    const std::uint32_t* fixed_pixels = fixed_.data() + word_index(y);
    const std::uint32_t* irregular = irregular_.data() + word_index(y);
    std::uint32_t* rough = finest.rough_row(y);
    for (int column = 0; column < tile_columns_; ++column) {
      if ((cells[column] | fixed_pixels[column]) == 0) continue;
      rough[column] = irregular[column] | fixed_pixels[column];
      finest.block(y, column) =
          cells[column] == ~0U && irregular[column] == 0 ? Block::plain : Block::general;
    }
  }
  finest.choose_tiles(nullptr, level_count_ > 1);
  finest.has_sources = !sources_.empty();
  for_rows(finest.rows(), [&](Rows rows) {
    membrane::set_weights(cells_.data(), fixed_.data(), words_per_row_, rows, finest);
  });
  for (const Boundary& boundary : sources_) {
    for (int c = 0; c < channels; ++c) {
      finest.right_side.data()[finest.cell_at(boundary.x, boundary.y, c)] += boundary.value[c];
    }
  }
  for (const Boundary& boundary : fixed_values_) {
    for (int c = 0; c < channels; ++c) {
      finest.x.data()[finest.cell_at(boundary.x, boundary.y, c)] = boundary.value[c];
    }
  }
  invert_diagonal(finest);

  for (std::size_t l = 1; l < level_count_; ++l) {
    const MembraneLevel& fine = levels_[l - 1];
    MembraneLevel& coarse = levels_[l];
    coarse.begin(half(fine.width), half(fine.height));
    coarse.has_sources = fine.has_sources;
    coarsen_blocks(fine, coarse);
    coarse.choose_tiles(&fine, l + 1 < level_count_);
    for_rows(coarse.rows(), [&](Rows rows) { membrane::coarsen(fine, rows, coarse); });
    invert_diagonal(coarse);
  }
  coarsest_.build(levels_[level_count_ - 1]);
}

void MembraneSolver::coarsen_blocks(const MembraneLevel& fine, MembraneLevel& coarse) const {
  // A bit for each pair of bits.
  const auto pairs = [](std::uint32_t bits) { return membrane::even_bits(bits | bits >> 1); };
  const auto fine_block = [&](int y, int column) {
    return y < fine.rows() && column < fine.tile_columns ? fine.block(y, column) : Block::empty;
  };
  for (int y = 0; y < coarse.height; ++y) {
    const std::uint32_t* upper = fine.rough_row(2 * y);
    const std::uint32_t* lower = upper + fine.tile_columns + 2;
    for (int column = 0; column < coarse.tile_columns; ++column) {
      const int left = std::min(2 * column, fine.tile_columns);
      const int right = std::min(2 * column + 1, fine.tile_columns);
      coarse.rough_row(y)[column] =
          pairs(upper[left] | lower[left]) | pairs(upper[right] | lower[right]) << 16;
      const Block children[] = {fine_block(2 * y, 2 * column), fine_block(2 * y, 2 * column + 1),
                                fine_block(2 * y + 1, 2 * column),
                                fine_block(2 * y + 1, 2 * column + 1)};
      const bool same = std::all_of(std::begin(children), std::end(children),
                                    [&](Block child) { return child == children[0]; });
      coarse.block(y, column) = same ? children[0] : Block::general;
    }
  }
}

double MembraneSolver::cycle(std::size_t l, bool from_zero) {
  MembraneLevel& level = levels_[l];
  const float* right_side = from_zero ? level.residual.data() : level.right_side.data();
  float* values = from_zero ? level.error.data() : level.x.data();
  relax(level, right_side, values, from_zero);
  if (l + 1 == level_count_) {
    for (int i = 1; i < coarsest_sweeps; ++i) relax(level, right_side, values, false);
    coarsest_.correct(level, right_side, values);
    for (int i = 0; i < coarsest_sweeps; ++i) relax(level, right_side, values, false);
    return 0;
  }
  MembraneLevel& coarse = levels_[l + 1];
  const double residual = restrict_residual(level, right_side, values, coarse);
  cycle(l + 1, true);
  membrane::extend_over_fixed(coarse, coarse.error.data());
  const double change = prolong(coarse, coarse.error.data(), true, level, values);
  if (level.has_smooth) membrane::add_error(coarse);
  relax(level, right_side, values, false);
  // A residual is about four times the error that it stands for.
  return change + residual / 16;
}

void MembraneSolver::solve(float tolerance) {
  cycles_ = 0;
  if (size_ == 0) return;
  build();
  const std::size_t last = level_count_ - 1;
  start_from_zero(levels_[last]);
  for (int i = 0; i < (last == 0 ? max_cycles : 2); ++i) cycle(last, false);
  const double finest_limit = static_cast<double>(tolerance) * static_cast<double>(tolerance) *
                              static_cast<double>(channels) * static_cast<double>(size_);
  for (std::size_t l = level_count_ - 1; l-- > 0;) {
    MembraneLevel& level = levels_[l];
    membrane::extend_over_fixed(levels_[l + 1], levels_[l + 1].x.data());
    prolong(levels_[l + 1], levels_[l + 1].x.data(), false, level, level.x.data());
    const double limit = std::ldexp(finest_limit, -2 * static_cast<int>(l));
    double before = 0;
    const int most = l == 0 ? max_cycles : 1;
    for (int i = 0; i < most; ++i) {
      const double change = cycle(l, false);
      if (l == 0) ++cycles_;
      if (change * left_of_error(before, change) < limit) break;
      before = change;
    }
  }
  relax_small_parts(tolerance);
  for (std::size_t l = level_count_ - 1; l-- > 1;) {
    if (levels_[l].has_smooth) membrane::fill_smooth(levels_[l], levels_[l + 1]);
  }
}

void MembraneSolver::read_block(int y, int column, float* result) const {
  membrane::read_block(levels_[0], levels_[std::min<std::size_t>(1, level_count_ - 1)], y, column,
                       result);
}

}  // namespace diminish
