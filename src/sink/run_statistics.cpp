#include "sink/run_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "sink/distribution.h"

namespace diminish {

namespace {

/// Without its digits.
std::string words_of(const std::string& message) {
  std::string words;
  std::copy_if(message.begin(), message.end(), std::back_inserter(words),
               [](char c) { return c < '0' || c > '9'; });
  return words;
}

}  // namespace

void RunStatistics::add(const FrameReport& report) {
  if (!report.faults.empty() || report.skipped) ++faulty_;
  const std::size_t number = frames_ + skipped_ + 1;
  for (const std::string& text : report.messages) {
    Message& message = messages_[words_of(text)];
    if (message.last == number) continue;
    if (message.frames++ == 0) message.first = text;
    message.last = number;
  }
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
  in_doubt_ += report.in_doubt ? 1 : 0;
  mask_pixels_ += report.mask_pixels;
  valid_pixels_ += report.valid_pixels;
  missing_pixels_ += report.missing_pixels;
  witnessed_pixels_ += report.witnessed_pixels;
  remembered_pixels_ += report.remembered_pixels;
  estimated_pixels_ += report.estimated_pixels;
  background_pixels_ += report.memory.background_pixels;
  if (report.remembered_pixels > report.memory.background_pixels) {
    median_ages_s_.push_back(report.memory.median_age_s);
    oldest_age_s_ = std::max(oldest_age_s_, report.memory.oldest_age_s);
  }
  ++frames_;
}

double RunStatistics::average_ms(std::size_t row) const {
  return frames_ > 0 ? times_[row].sum_ms / static_cast<double>(frames_) : 0;
}

Shares RunStatistics::shares() const {
  return shares_of(mask_pixels_, valid_pixels_, witnessed_pixels_, remembered_pixels_,
                   estimated_pixels_);
}

std::optional<RunStatistics::Ages> RunStatistics::remembered_ages() const {
  if (median_ages_s_.empty()) return std::nullopt;
  return Ages{distribution_of(median_ages_s_).p50, oldest_age_s_};
}

std::map<std::string, std::size_t> RunStatistics::messages() const {
  std::map<std::string, std::size_t> counts;
  for (const auto& [words, message] : messages_) counts[message.first] += message.frames;
  return counts;
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
  text += fmt::format("{} frames; of the objects' pixels {}\n", frames_, to_text(shares(), 1));
  if (const auto ages = remembered_ages()) {
    text +=
        fmt::format("Remembered pixels were seen {:.1f} s before (median), the oldest {:.1f} s\n",
                    ages->median_s, ages->oldest_s);
  }
  if (background_pixels_ > 0) {
    text += fmt::format(
        "Of the remembered pixels {:.1f} % come from the background's scan\n",
        100 * static_cast<double>(background_pixels_) / static_cast<double>(remembered_pixels_));
  }
  if (skipped_ > 0) text += fmt::format("{} frames skipped: no colour image\n", skipped_);
  for (const auto& [message, count] : messages()) {
    text += fmt::format("{} of {} frames: {}\n", count, frames_ + skipped_, message);
  }
  return text;
}

}  // namespace diminish
