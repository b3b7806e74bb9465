#pragma once

#include "diminish/diminished_frame.h"
#include "diminish/export.h"
#include "diminish/frame_set.h"

namespace diminish {

/// Takes finished frames. Throws Error, for example when the disk is full; that ends the run.
class DIMINISH_EXPORT FrameSink {
 public:
  virtual ~FrameSink() = default;

  /// The part of the work that needs no order, such as compressing pictures. Called for several
  /// frames at the same time from several threads.
  virtual void write_images(const FrameSet& frame, const DiminishedFrame& result) = 0;

  /// The part that needs order. Called frame after frame, after the frame's `write_images`.
  virtual void append(const FrameSet& frame, const DiminishedFrame& result) = 0;
};

}  // namespace diminish
