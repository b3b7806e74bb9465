#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "diminish/export.h"
#include "diminish/frame_sink.h"
#include "diminish/options.h"
#include "diminish/rig.h"

namespace diminish {

struct ResultWriterOptions {
  /// Write only pictures with input and result side by side (and the tables).
  bool preview_only = false;
  /// Replace existing results in the folder.
  bool force = false;
};

/// Writes a run's results into a folder: result/, mask/, reconstruction/, provenance/ (or
/// preview/), frames.csv, summary.json, result.mp4 (docs/results.md). Every file is complete
/// at any moment.
class DIMINISH_EXPORT ResultWriter : public FrameSink {
 public:
  /// Throws Error if the folder cannot be created, or is not empty and `force` is not set. `force`
  /// removes only what this class writes.
  ResultWriter(std::filesystem::path folder, const Rig& rig, const Options& options,
               double frames_per_second, const ResultWriterOptions& writer_options);
  ~ResultWriter() override;

  void write_images(const FrameSet& frame, const DiminishedFrame& result) override;
  void append(const FrameSet& frame, const DiminishedFrame& result) override;
  /// Ends the video and writes the summary. Returns why there is no video, if there is none.
  std::string finish(bool interrupted);

  /// Frames with an unusable image, including skipped ones.
  std::size_t faulty_frames() const;
  /// For a terminal: the stages' times beside the paper's, and what was not found in how many
  /// frames.
  std::string table() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
