#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>

#include "diminish/diminished_frame.h"

namespace diminish {

/// A row of the paper's Table 2 (Meerits & Saito 2015, on an i7-4770K and a GTX 780).
struct PaperRow {
  const char* operation;
  std::size_t stage;  ///< stage_count: the whole frame
  const char* paper_ms;
};
std::span<const PaperRow> paper_table();

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
  std::size_t mask_pixels() const { return mask_pixels_; }
  std::size_t valid_pixels() const { return valid_pixels_; }
  std::size_t missing_pixels() const { return missing_pixels_; }
  double average_ms(std::size_t stage) const;
  /// Per stage; the last one is the whole frame.
  const std::array<Times, stage_count + 1>& times() const { return times_; }
  /// Messages about what was not found or could not be done, with the number of frames.
  const std::map<std::string, std::size_t>& messages() const { return messages_; }

  /// The paper's Table 2 for this run beside the paper's own figures, then the messages with the
  /// number of frames.
  std::string table() const;

 private:
  std::size_t frames_ = 0, skipped_ = 0, faulty_ = 0;
  std::size_t mask_pixels_ = 0, valid_pixels_ = 0, missing_pixels_ = 0;
  std::array<Times, stage_count + 1> times_{};
  std::map<std::string, std::size_t> messages_;
};

}  // namespace diminish
