#pragma once

#include "diminish/diminished_frame.h"
#include "diminish/export.h"
#include "diminish/frame_set.h"

namespace diminish {

/// Where frames go. Errors (a full disk) are thrown as Error and end the run.
class DIMINISH_EXPORT FrameSink {
 public:
  virtual ~FrameSink() = default;

  /// The part of the work that needs no order, such as compressing pictures. Called for several
  /// frames at a time from several threads.
  virtual void write_images(const FrameSet& frame, const DiminishedFrame& result) = 0;

  /// The part that does: called frame after frame, after the frame's `write_images`.
  virtual void append(const FrameSet& frame, const DiminishedFrame& result) = 0;
};

}  // namespace diminish
