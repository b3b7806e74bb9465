#include <fmt/format.h>
#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <cstring>
#include <memory>

#include "diminish/camera_source.h"
#include "diminish/error.h"

namespace diminish {
namespace {

struct Unref {
  void operator()(GstElement* element) const { gst_object_unref(element); }
  void operator()(GstBus* bus) const { gst_object_unref(bus); }
  void operator()(GstSample* sample) const { gst_sample_unref(sample); }
  void operator()(GstMessage* message) const { gst_message_unref(message); }
  void operator()(GstCaps* caps) const { gst_caps_unref(caps); }
  void operator()(GError* error) const { g_error_free(error); }
};
template <class Thing>
using Owned = std::unique_ptr<Thing, Unref>;

void initialize(const CameraUri& uri) {
  GError* raw = nullptr;
  if (gst_init_check(nullptr, nullptr, &raw) == TRUE) return;
  const Owned<GError> error(raw);
  uri.fail(std::string("GStreamer does not start: ") + (error ? error->message : "no reason given"),
           Error::device);
}

/// Any GStreamer pipeline: BGR frames are colour images, GRAY16_LE frames are depth.
class GstreamerCamera : public CameraSource {
 public:
  GstreamerCamera(const CameraUri& uri, const CameraRequest&) : uri_(uri) {
    initialize(uri);
    GError* raw = nullptr;
    // One image waits at most: a newer one takes its place.
    const std::string text = uri.target +
                             " ! appsink name=diminish_sink max-buffers=1 drop=true sync=false"
                             " caps=\"video/x-raw,format=(string){BGR,GRAY16_LE}\"";
    pipeline_.reset(gst_parse_launch(text.c_str(), &raw));
    const Owned<GError> error(raw);
    if (!pipeline_ || error) {
      uri.fail(std::string("the pipeline cannot be made: ") + (error ? error->message : "?"));
    }
    sink_.reset(gst_bin_get_by_name(GST_BIN(pipeline_.get()), "diminish_sink"));
    bus_.reset(gst_element_get_bus(pipeline_.get()));
    if (gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE) {
      throw_error("the pipeline does not start");
    }
  }
  ~GstreamerCamera() override { gst_element_set_state(pipeline_.get(), GST_STATE_NULL); }

  Status read(CameraImage& image, std::chrono::milliseconds timeout) override {
    const auto timeout_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout).count();
    const Owned<GstSample> sample(gst_app_sink_try_pull_sample(
        GST_APP_SINK(sink_.get()), static_cast<GstClockTime>(timeout_ns)));
    if (sample) {
      take(*sample, image);
      return Status::image;
    }
    const Owned<GstMessage> message(gst_bus_pop_filtered(bus_.get(), GST_MESSAGE_ERROR));
    if (message) throw_error(*message);
    return gst_app_sink_is_eos(GST_APP_SINK(sink_.get())) == TRUE ? Status::end : Status::nothing;
  }

 private:
  [[noreturn]] void throw_error(const std::string& what) const {
    const Owned<GstMessage> message(gst_bus_pop_filtered(bus_.get(), GST_MESSAGE_ERROR));
    if (message) throw_error(*message);
    gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
    uri_.fail(what, Error::device);
  }
  [[noreturn]] void throw_error(GstMessage& message) const {
    GError* raw = nullptr;
    gst_message_parse_error(&message, &raw, nullptr);
    const Owned<GError> error(raw);
    gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
    uri_.fail(error->message, Error::device);
  }

  /// When the buffer was made: its time on the pipeline's clock, if that is the monotonic one.
  double stamp_s(GstBuffer& buffer) const {
    const double now_s = monotonic_now_s();
    const GstClockTime base_ns = gst_element_get_base_time(pipeline_.get());
    if (!GST_BUFFER_PTS_IS_VALID(&buffer) || base_ns == GST_CLOCK_TIME_NONE) return now_s;
    const double stamp = static_cast<double>(base_ns + GST_BUFFER_PTS(&buffer)) * 1e-9;
    return stamp > now_s - 1 && stamp <= now_s ? stamp : now_s;
  }

  void take(GstSample& sample, CameraImage& image) const {
    GstBuffer* buffer = gst_sample_get_buffer(&sample);
    GstVideoInfo info;
    GstVideoFrame frame;
    image.fault.clear();
    image.stamp_s = stamp_s(*buffer);
    if (gst_video_info_from_caps(&info, gst_sample_get_caps(&sample)) != TRUE ||
        gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ) != TRUE) {
      image.fault = "an image cannot be read";
      return;
    }
    const bool is_depth = GST_VIDEO_INFO_FORMAT(&info) == GST_VIDEO_FORMAT_GRAY16_LE;
    image.sensor = is_depth ? Sensor::depth : Sensor::color;
    if (is_depth) {
      copy(frame, image.depth);
    } else {
      copy(frame, image.color);
    }
    gst_video_frame_unmap(&frame);
  }

  template <class Pixel>
  static void copy(const GstVideoFrame& frame, Image<Pixel>& image) {
    image.resize(GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame));
    const auto* bytes = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0));
    const auto stride = static_cast<std::size_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0));
    for (int y = 0; y < image.height(); ++y) {
      std::memcpy(image.row(y), bytes + static_cast<std::size_t>(y) * stride,
                  static_cast<std::size_t>(image.width()) * sizeof(Pixel));
    }
  }

  CameraUri uri_;
  Owned<GstElement> pipeline_;
  Owned<GstElement> sink_;
  Owned<GstBus> bus_;
};

const bool gstreamer_camera_registered = Registry<CameraSource>::add(
    "gst", {.open =
                [](const CameraUri& uri, const CameraRequest& request) {
                  return std::make_unique<GstreamerCamera>(uri, request);
                },
            .list = {},
            .help = "gst:PIPELINE  frames of a GStreamer pipeline: BGR is colour, GRAY16_LE depth",
            .free_text = true});

}  // namespace
}  // namespace diminish
