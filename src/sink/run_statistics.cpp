#include "sink/run_statistics.h"

#include <fmt/format.h>

#include <algorithm>

namespace diminish {

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
  const auto ms = times_of(report);
  for (std::size_t row = 0; row < time_row_count; ++row) count(times_[row], ms[row]);
  mask_pixels_ += report.mask_pixels;
  valid_pixels_ += report.valid_pixels;
  missing_pixels_ += report.missing_pixels;
  witnessed_pixels_ += report.witnessed_pixels;
  remembered_pixels_ += report.remembered_pixels;
  ++frames_;
}

double RunStatistics::average_ms(std::size_t row) const {
  return frames_ > 0 ? times_[row].sum_ms / static_cast<double>(frames_) : 0;
}

std::string RunStatistics::table() const {
  std::string text;
  for (const TimeGroup& group : time_groups) {
    text += fmt::format("{:<20}{:>10}{:>10}{:>10}{:>16}\n", group.title, "avg", "min", "max",
                        group.paper_title);
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const TimeRow& row = time_rows()[i];
      text += fmt::format("{:<20}{:>10.1f}{:>10.1f}{:>10.1f}{:>16}\n", row.title, average_ms(i),
                          times_[i].min_ms, times_[i].max_ms, row.paper_ms);
    }
  }
  const auto share = [&](std::size_t pixels) {
    return 100 * static_cast<double>(pixels) /
           static_cast<double>(std::max<std::size_t>(mask_pixels_, 1));
  };
  text += fmt::format("{} frames; of the objects' pixels {:.1f} % seen, {:.1f} % not", frames_,
                      share(valid_pixels_ - remembered_pixels_),
                      share(missing_pixels_ + remembered_pixels_));
  if (witnessed_pixels_ + remembered_pixels_ > 0) {
    text += fmt::format("; {:.1f} % remembered and still there, {:.1f} % only remembered",
                        share(witnessed_pixels_), share(remembered_pixels_));
  }
  text += '\n';
  if (skipped_ > 0) text += fmt::format("{} frames skipped: no colour image\n", skipped_);
  for (const auto& [message, count] : messages_) {
    text += fmt::format("{} of {} frames: {}\n", count, frames_ + skipped_, message);
  }
  return text;
}

}  // namespace diminish
