#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "diminish/export.h"
#include "diminish/frame_set.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// Delivers frames.
class DIMINISH_EXPORT FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Reads the next frame into `frame`, reusing its memory; false at the end. An unusable image is
  /// a fault of its frame, not an error.
  virtual bool next(FrameSet& frame) = 0;

  // The same in two steps, to read several frames at a time.

  /// The part that needs order. False at the end.
  virtual bool begin(FrameSet& frame) { return next(frame); }
  /// The part that needs no order, such as decoding pictures. May be called for several frames at
  /// the same time from several threads.
  virtual void read_images(FrameSet&) {}

  /// The number of frames if known in advance, else 0.
  virtual std::size_t frame_count() const { return 0; }

  /// The colour stream's mean rate; 0 if unknown.
  virtual double frames_per_second() const { return 0; }
};

/// A recording's folder (docs/recording-format.md): configuration and frames.
struct Recording {
  std::filesystem::path folder;
  Rig rig;
  Scene scene;
};

/// Reads a recording's rig.yaml and scene.yaml. Throws Error that names file and key.
DIMINISH_EXPORT Recording load_recording(const std::filesystem::path& folder);

/// The frames of a recording: for each colour image the RGB-D images nearest in time, within
/// `options.sync_tolerance_s`. Throws Error if a stream's list is missing, malformed or empty.
DIMINISH_EXPORT std::unique_ptr<FrameSource> open_recording(const Recording& recording,
                                                            const Options& options);

}  // namespace diminish
