#pragma once

#include <gst/base/gstaggregator.h>
#include <gst/video/video.h>

#include "diminish_c.h"

namespace diminish::gst {

/// A buffer of a pad, readable as an image for as long as it lives.
class MappedImage {
 public:
  /// Takes the buffer; null: no image.
  MappedImage(GstAggregatorPad* pad, GstBuffer* buffer);
  ~MappedImage();
  MappedImage(const MappedImage&) = delete;
  MappedImage& operator=(const MappedImage&) = delete;

  bool is_mapped() const { return is_mapped_; }
  diminish_image view() const;

 private:
  GstBuffer* buffer_ = nullptr;
  GstVideoFrame frame_ = {};
  bool is_mapped_ = false;
};

/// What a pad has for a moment: an image of then, one of later, none yet, or none any more.
enum class Supply { now, later, not_yet, ended };

/// Drops the pad's buffers from before `stamp - tolerance`; looks at the first one that is left. Up
/// to `stamp + tolerance` it is of that moment; a buffer without a time is of any.
Supply look(GstAggregatorPad* pad, GstClockTime stamp, GstClockTime tolerance);

}  // namespace diminish::gst
