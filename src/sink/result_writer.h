#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "diminish/frame_sink.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "sink/frames_csv.h"
#include "sink/run_statistics.h"
#include "sink/video_file.h"

namespace diminish {

struct ResultWriterOptions {
  /// Write only pictures with input and result side by side (and the tables).
  bool preview_only = false;
  /// Replace existing results in the folder.
  bool force = false;
};

/// Writes a run's results into a folder: result/, mask/, reconstruction/, provenance/ (or
/// preview/), frames.csv, summary.json, result.mp4. Every file is complete at any moment.
class ResultWriter : public FrameSink {
 public:
  /// Throws Error if the folder cannot be created, or is not empty and `force` is not set. `force`
  /// removes only what this class writes.
  ResultWriter(std::filesystem::path folder, const Rig& rig, const Options& options,
               double frames_per_second, const ResultWriterOptions& writer_options);

  void write_images(const FrameSet& frame, const DiminishedFrame& result) override;
  void append(const FrameSet& frame, const DiminishedFrame& result) override;
  /// Ends the video and writes the summary. Returns why there is no video, if there is none.
  std::string finish(bool interrupted);

  const RunStatistics& statistics() const { return statistics_; }

 private:
  void prepare_folder(bool force) const;
  void write_summary(bool interrupted, const std::string& video_problem) const;

  std::filesystem::path folder_;
  Options options_;
  bool preview_only_;
  std::optional<FramesCsv> csv_;
  std::optional<VideoFile> video_;
  RunStatistics statistics_;
};

}  // namespace diminish
