#include "rgbd_images.h"

namespace diminish::gst {

MappedImage::MappedImage(GstAggregatorPad* pad, GstBuffer* buffer) : buffer_(buffer) {
  if (buffer_ == nullptr) return;
  GstVideoInfo info;
  GstCaps* caps = gst_pad_get_current_caps(GST_PAD(pad));
  if (caps == nullptr) return;
  const bool is_video = gst_video_info_from_caps(&info, caps) != FALSE;
  gst_caps_unref(caps);
  is_mapped_ = is_video && gst_video_frame_map(&frame_, &info, buffer_, GST_MAP_READ) != FALSE;
}

MappedImage::~MappedImage() {
  if (is_mapped_) gst_video_frame_unmap(&frame_);
  if (buffer_ != nullptr) gst_buffer_unref(buffer_);
}

diminish_image MappedImage::view() const {
  if (!is_mapped_) return {};
  return {GST_VIDEO_FRAME_PLANE_DATA(&frame_, 0), GST_VIDEO_FRAME_WIDTH(&frame_),
          GST_VIDEO_FRAME_HEIGHT(&frame_), GST_VIDEO_FRAME_PLANE_STRIDE(&frame_, 0)};
}

Supply look(GstAggregatorPad* pad, GstClockTime stamp, GstClockTime tolerance) {
  while (true) {
    GstBuffer* first = gst_aggregator_pad_peek_buffer(pad);
    if (first == nullptr) {
      return gst_aggregator_pad_is_eos(pad) != FALSE ? Supply::ended : Supply::not_yet;
    }
    const GstClockTime its_stamp = GST_BUFFER_PTS(first);
    gst_buffer_unref(first);
    if (!GST_CLOCK_TIME_IS_VALID(its_stamp) || !GST_CLOCK_TIME_IS_VALID(stamp)) return Supply::now;
    if (its_stamp > stamp + tolerance) return Supply::later;
    if (its_stamp + tolerance >= stamp) return Supply::now;
    gst_aggregator_pad_drop_buffer(pad);
  }
}

}  // namespace diminish::gst
