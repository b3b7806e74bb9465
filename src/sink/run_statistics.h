#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diminish/diminished_frame.h"
#include "sink/shares.h"
#include "sink/time_table.h"

namespace diminish {

/// Sums over a run's frames.
class RunStatistics {
 public:
  void add(const FrameReport& report);

  struct Times {
    double sum_ms = 0, min_ms = 0, max_ms = 0;
  };

  std::size_t frames() const { return frames_; }    ///< with a picture
  std::size_t skipped() const { return skipped_; }  ///< without
  /// Frames with an unusable image, including skipped ones.
  std::size_t faulty() const { return faulty_; }
  std::size_t in_doubt() const { return in_doubt_; }
  std::size_t mask_pixels() const { return mask_pixels_; }
  std::size_t valid_pixels() const { return valid_pixels_; }
  std::size_t missing_pixels() const { return missing_pixels_; }
  std::size_t witnessed_pixels() const { return witnessed_pixels_; }
  std::size_t remembered_pixels() const { return remembered_pixels_; }
  std::size_t estimated_pixels() const { return estimated_pixels_; }
  std::size_t background_pixels() const { return background_pixels_; }
  Shares shares() const;
  /// How long ago the remembered pixels were seen, but for a scan's; nothing if there were none.
  struct Ages {
    double median_s = 0;  ///< of the frames' medians
    double oldest_s = 0;
  };
  std::optional<Ages> remembered_ages() const;
  /// By row of the table of times.
  double average_ms(std::size_t row) const;
  const std::array<Times, time_row_count>& times() const { return times_; }
  /// Messages about what was not found or could not be done, with the number of frames. Those that
  /// differ in numbers only (times, files) count as the first of them, so that an endless run's do
  /// not grow.
  std::map<std::string, std::size_t> messages() const;

  /// The times of the stages, the paper's Table 2 beside its own figures, then the messages with
  /// the number of frames.
  std::string table() const;

 private:
  std::size_t frames_ = 0, skipped_ = 0, faulty_ = 0, in_doubt_ = 0;
  std::size_t mask_pixels_ = 0, valid_pixels_ = 0, missing_pixels_ = 0;
  std::size_t witnessed_pixels_ = 0, remembered_pixels_ = 0, background_pixels_ = 0;
  std::size_t estimated_pixels_ = 0;
  std::vector<double> median_ages_s_;  ///< of frames with something remembered
  double oldest_age_s_ = 0;
  std::array<Times, time_row_count> times_{};
  struct Message {
    std::string first;
    std::size_t frames = 0;
    std::size_t last = 0;  ///< frame, from 1 on: one may say it of several things
  };
  std::map<std::string, Message> messages_;  ///< by their words
};

}  // namespace diminish
