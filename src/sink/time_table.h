#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "diminish/diminished_frame.h"

namespace diminish {

/// A row of a table of times: a stage of the frame; an operation of the paper's Table 2 (Meerits &
/// Saito 2015, on an i7-4770K and a GTX 780), which sums stages; or the whole frame.
struct TimeRow {
  const char* key;       ///< in files
  const char* title;     ///< in tables
  const char* paper_ms;  ///< the paper's own figure; empty for stages
};
inline constexpr std::size_t paper_row_count = 5;
inline constexpr std::size_t time_row_count = stage_count + paper_row_count + 1;
/// The index of the whole frame's row, the last.
inline constexpr std::size_t whole_frame_row = time_row_count - 1;

/// Rows that stand under one heading: [begin, end).
struct TimeGroup {
  const char* title;
  const char* paper_title;  ///< of the column of the paper's figures
  std::size_t begin, end;
};
/// The stages; then the paper's operations and the whole frame.
inline constexpr std::array<TimeGroup, 2> time_groups{
    {{"Stage, ms", "", 0, stage_count}, {"Table 2, ms", "paper", stage_count, time_row_count}}};

/// The stages by Stage, the paper's operations, the frame.
std::span<const TimeRow, time_row_count> time_rows();

/// A frame's milliseconds, row by row.
std::array<double, time_row_count> times_of(const FrameReport& report);

}  // namespace diminish
