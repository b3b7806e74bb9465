#include "sink/run_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace diminish {
namespace {

// The paper measures poses and detection together.
constexpr PaperRow rows[] = {
    {"Camera poses", 0, "8.2"},        {"Object detection", 1, "(with poses)"},
    {"Reconstruction", 2, "12.8"},     {"Compositing", 3, "1.1"},
    {"Colour correction", 4, "13256"}, {"Inpainting", 5, "1871"},
    {"Total", stage_count, "15149"}};

}  // namespace

std::span<const PaperRow> paper_table() {
  return rows;
}

void RunStatistics::add(const FrameReport& report) {
  if (!report.faults.empty() || report.skipped) ++faulty_;
  for (const std::string& message : report.messages) ++messages_[message];
  if (report.skipped) {
    ++skipped_;
    return;
  }
  const auto count = [&](Times& times, double ms) {
    times.min_ms = frames_ == 0 ? ms : std::min(times.min_ms, ms);
    times.max_ms = frames_ == 0 ? ms : std::max(times.max_ms, ms);
    times.sum_ms += ms;
  };
  const StageTimes& ms = report.milliseconds;
  for (std::size_t stage = 0; stage < stage_count; ++stage) count(times_[stage], ms[stage]);
  count(times_[stage_count], std::accumulate(ms.begin(), ms.end(), 0.0));
  mask_pixels_ += report.mask_pixels;
  valid_pixels_ += report.valid_pixels;
  missing_pixels_ += report.missing_pixels;
  ++frames_;
}

double RunStatistics::average_ms(std::size_t stage) const {
  return frames_ > 0 ? times_[stage].sum_ms / static_cast<double>(frames_) : 0;
}

std::string RunStatistics::table() const {
  std::string text = fmt::format("{:<20}{:>10}{:>10}{:>10}{:>16}\n", "Operation, ms", "avg", "min",
                                 "max", "paper");
  for (const PaperRow& row : rows) {
    const Times& times = times_[row.stage];
    text += fmt::format("{:<20}{:>10.1f}{:>10.1f}{:>10.1f}{:>16}\n", row.operation,
                        average_ms(row.stage), times.min_ms, times.max_ms, row.paper_ms);
  }
  const double mask = static_cast<double>(std::max<std::size_t>(mask_pixels_, 1));
  text += fmt::format("{} frames; of the objects' pixels {:.1f} % seen, {:.1f} % not\n", frames_,
                      100 * static_cast<double>(valid_pixels_) / mask,
                      100 * static_cast<double>(missing_pixels_) / mask);
  if (skipped_ > 0) text += fmt::format("{} frames skipped: no colour image\n", skipped_);
  for (const auto& [message, count] : messages_) {
    text += fmt::format("{} of {} frames: {}\n", count, frames_ + skipped_, message);
  }
  return text;
}

}  // namespace diminish
