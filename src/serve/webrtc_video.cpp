#include "serve/webrtc_video.h"

#define GST_USE_UNSTABLE_API  // GStreamer's name for its WebRTC library, the same since 1.14
#include <fmt/format.h>
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <gst/sdp/sdp.h>
#include <gst/video/video.h>
#include <gst/webrtc/webrtc.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include "diminish/camera_source.h"
#include "diminish/error.h"

namespace diminish {
namespace {

constexpr double longest_gathering_s = 3;
constexpr double longest_connecting_s = 10;
/// At a million pixels and 30 frames/s hardly worse to the eye than JPEG at quality 85, which
/// takes six times as much.
constexpr double bits_per_pixel_and_second = 6;
constexpr GstClockTime ns_per_s = 1'000'000'000;

struct Unref {
  void operator()(GstElement* element) const { gst_object_unref(element); }
  void operator()(GstObject* object) const { gst_object_unref(object); }
  void operator()(GstBus* bus) const { gst_object_unref(bus); }
  void operator()(GstClock* clock) const { gst_object_unref(clock); }
  void operator()(GstCaps* caps) const { gst_caps_unref(caps); }
  void operator()(GstMessage* message) const { gst_message_unref(message); }
  void operator()(GstPromise* promise) const { gst_promise_unref(promise); }
  void operator()(GstWebRTCSessionDescription* description) const {
    gst_webrtc_session_description_free(description);
  }
  void operator()(GError* error) const { g_error_free(error); }
  void operator()(gchar* text) const { g_free(text); }
};
template <class Thing>
using Owned = std::unique_ptr<Thing, Unref>;

[[noreturn]] void fail(const std::string& what) {
  throw Error(Error::device, "webrtc: " + what);
}

std::string find_what_is_missing() {
  GError* raw = nullptr;
  if (gst_init_check(nullptr, nullptr, &raw) != TRUE) {
    const Owned<GError> error(raw);
    return std::string("video: GStreamer does not start: ") + (error ? error->message : "?");
  }
  struct Needed {
    const char* element;
    const char* package;
  };
  constexpr std::array needed = {Needed{"appsrc", "base"},   Needed{"videoconvert", "base"},
                                 Needed{"vp8enc", "good"},   Needed{"rtpvp8pay", "good"},
                                 Needed{"webrtcbin", "bad"}, Needed{"dtlssrtpenc", "bad"},
                                 Needed{"srtpenc", "bad"}};
  const auto is_there = [](const char* element) {
    const Owned<GstObject> factory(GST_OBJECT_CAST(gst_element_factory_find(element)));
    return factory != nullptr;
  };
  for (const auto& [element, package] : needed) {
    if (!is_there(element)) {
      return fmt::format("video: expected GStreamer's {}; install gstreamer1.0-plugins-{}", element,
                         package);
    }
  }
  if (!is_there("nicesink")) return "video: expected nicesink; install gstreamer1.0-nice";
  return {};
}

/// What webrtcbin answers to `action`, which must not be an error.
template <class... Arguments>
Owned<GstPromise> ask(GstElement* peer, const char* action, Arguments... arguments) {
  Owned<GstPromise> promise(gst_promise_new());
  g_signal_emit_by_name(peer, action, arguments..., promise.get());
  if (gst_promise_wait(promise.get()) != GST_PROMISE_RESULT_REPLIED) {
    fail(std::string(action) + ": no answer");
  }
  const GstStructure* reply = gst_promise_get_reply(promise.get());
  if (reply && gst_structure_has_field(reply, "error")) {
    GError* raw = nullptr;
    gst_structure_get(reply, "error", G_TYPE_ERROR, &raw, nullptr);
    const Owned<GError> error(raw);
    throw Error(std::string("webrtc: sdp: ") + (error ? error->message : "cannot be answered"));
  }
  return promise;
}

Owned<GstWebRTCSessionDescription> description_of(const WebRtcOffer& offer) {
  GstSDPMessage* message = nullptr;
  if (gst_sdp_message_new_from_text(offer.sdp.c_str(), &message) != GST_SDP_OK) {
    throw Error("webrtc: sdp: expected a session description");
  }
  return Owned<GstWebRTCSessionDescription>(
      gst_webrtc_session_description_new(GST_WEBRTC_SDP_TYPE_OFFER, message));
}

int property(GstElement* element, const char* name) {
  int value = 0;
  g_object_get(element, name, &value, nullptr);
  return value;
}

/// A frame's picture as GStreamer's. The frame lives as long.
GstBuffer* wrap(const std::shared_ptr<const LiveFrame>& frame, ImageView<Bgr> picture) {
  using Kept = std::shared_ptr<const LiveFrame>;
  const auto width = static_cast<guint>(picture.width());
  const auto height = static_cast<guint>(picture.height());
  const auto stride_bytes = static_cast<gsize>(picture.stride());
  const gsize size = stride_bytes * (height - 1) + gsize{3} * width;
  GstBuffer* buffer = gst_buffer_new_wrapped_full(
      GST_MEMORY_FLAG_READONLY, const_cast<Bgr*>(picture.data()), size, 0, size, new Kept(frame),
      [](gpointer kept) { delete static_cast<Kept*>(kept); });
  std::array<gsize, GST_VIDEO_MAX_PLANES> offsets{};
  std::array<gint, GST_VIDEO_MAX_PLANES> strides{static_cast<gint>(stride_bytes)};
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_BGR, width,
                                 height, 1, offsets.data(), strides.data());
  return buffer;
}

}  // namespace

std::string why_no_webrtc() {
  static const std::string why = find_what_is_missing();
  return why;
}

struct WebRtcVideo::Implementation {
  Implementation(const WebRtcOffer& offer, const std::string& address) : view(offer.view) {
    make_pipeline(offer.vp8_payload_type);
    if (!address.empty()) gather_only_at(address);
    if (gst_element_set_state(pipeline.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE) {
      fail("the pipeline does not start");
    }
    const auto remote = description_of(offer);
    ask(peer.get(), "set-remote-description", remote.get());
    const auto promise = ask(peer.get(), "create-answer", static_cast<GstStructure*>(nullptr));
    GstWebRTCSessionDescription* raw = nullptr;
    gst_structure_get(gst_promise_get_reply(promise.get()), "answer",
                      GST_TYPE_WEBRTC_SESSION_DESCRIPTION, &raw, nullptr);
    const Owned<GstWebRTCSessionDescription> local(raw);
    if (!local) fail("no answer to the offer");
    ask(peer.get(), "set-local-description", local.get());
    answer = gathered(address);
  }
  ~Implementation() {
    if (pipeline) gst_element_set_state(pipeline.get(), GST_STATE_NULL);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void make_pipeline(int payload_type) {
    // One frame waits at most; a newer one takes its place. Keyframes come when the viewer asks.
    const std::string text = fmt::format(
        "appsrc name=source is-live=true format=time max-buffers=1 leaky-type=downstream"
        " ! videoconvert"
        " ! vp8enc name=encoder deadline=1 cpu-used=8 threads=1 end-usage=cbr"
        " keyframe-max-dist=3000 buffer-size=300 buffer-initial-size=200 buffer-optimal-size=250"
        " undershoot=95 overshoot=20 error-resilient=default"
        " ! rtpvp8pay pt={0} picture-id-mode=15-bit timestamp-offset=0"
        " ! application/x-rtp,media=video,encoding-name=VP8,clock-rate=90000,payload={0}"
        " ! webrtcbin name=peer bundle-policy=max-bundle",
        payload_type);
    GError* raw = nullptr;
    pipeline.reset(gst_parse_launch(text.c_str(), &raw));
    const Owned<GError> error(raw);
    if (!pipeline || error) fail(error ? error->message : "the pipeline cannot be made");
    peer.reset(gst_bin_get_by_name(GST_BIN(pipeline.get()), "peer"));
    source.reset(gst_bin_get_by_name(GST_BIN(pipeline.get()), "source"));
    encoder.reset(gst_bin_get_by_name(GST_BIN(pipeline.get()), "encoder"));
    bus.reset(gst_element_get_bus(pipeline.get()));
    // The pipeline's time is the monotonic clock itself.
    const Owned<GstClock> clock(gst_system_clock_obtain());
    gst_pipeline_use_clock(GST_PIPELINE(pipeline.get()), clock.get());
    gst_element_set_start_time(pipeline.get(), GST_CLOCK_TIME_NONE);
    gst_element_set_base_time(pipeline.get(), 0);
  }

  void gather_only_at(const std::string& address) {
    GstObject* raw = nullptr;
    g_object_get(peer.get(), "ice-agent", &raw, nullptr);
    const Owned<GstObject> agent(raw);
    gboolean is_added = FALSE;
    if (agent)
      g_signal_emit_by_name(agent.get(), "add-local-ip-address", address.c_str(), &is_added);
    if (is_added != TRUE) fail(address + ": expected an address in numbers, such as 127.0.0.1");
  }

  /// The session's description with all candidates.
  std::string gathered(const std::string& address) const {
    const double end_s = monotonic_now_s() + longest_gathering_s;
    while (property(peer.get(), "ice-gathering-state") != GST_WEBRTC_ICE_GATHERING_STATE_COMPLETE &&
           monotonic_now_s() < end_s) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    GstWebRTCSessionDescription* raw = nullptr;
    g_object_get(peer.get(), "local-description", &raw, nullptr);
    const Owned<GstWebRTCSessionDescription> local(raw);
    const Owned<gchar> text(local ? gst_sdp_message_as_text(local->sdp) : nullptr);
    std::string sdp = text ? text.get() : "";
    if (sdp.find("a=candidate:") == std::string::npos) {
      fail((address.empty() ? "this machine" : address) + ": no port can be opened there");
    }
    return sdp;
  }

  void set_size(int width, int height) {
    if (size == std::pair(width, height)) return;
    size = {width, height};
    const Owned<GstCaps> caps(gst_caps_new_simple(
        "video/x-raw", "format", G_TYPE_STRING, "BGR", "width", G_TYPE_INT, width, "height",
        G_TYPE_INT, height, "framerate", GST_TYPE_FRACTION, 30, 1, nullptr));
    gst_app_src_set_caps(GST_APP_SRC(source.get()), caps.get());
    g_object_set(encoder.get(), "target-bitrate",
                 static_cast<int>(bits_per_pixel_and_second * width * height), nullptr);
  }

  View view;
  Owned<GstElement> pipeline, peer, source, encoder;
  Owned<GstBus> bus;
  std::string answer;
  std::pair<int, int> size;
  GstClockTime last_ns = 0;
  double begun_s = monotonic_now_s();
};

WebRtcVideo::WebRtcVideo(const WebRtcOffer& offer, const std::string& address) {
  if (const std::string why = why_no_webrtc(); !why.empty()) throw Error(Error::device, why);
  implementation_ = std::make_unique<Implementation>(offer, address);
}
WebRtcVideo::~WebRtcVideo() = default;

const std::string& WebRtcVideo::answer() const {
  return implementation_->answer;
}

void WebRtcVideo::send(const std::shared_ptr<const LiveFrame>& frame) {
  Implementation& self = *implementation_;
  const ImageView<Bgr> picture =
      self.view == View::before ? frame->input.color.view() : ImageView<Bgr>(frame->result.picture);
  self.set_size(picture.width(), picture.height());
  GstBuffer* buffer = wrap(frame, picture);
  // A camera's clock may be set back, a video's may not.
  const auto stamp_ns = static_cast<GstClockTime>(std::max(0.0, frame->input.stamp_s) *
                                                  static_cast<double>(ns_per_s));
  self.last_ns = std::max(stamp_ns, self.last_ns + 1);
  GST_BUFFER_PTS(buffer) = self.last_ns;
  gst_app_src_push_buffer(GST_APP_SRC(self.source.get()), buffer);  // takes it
}

bool WebRtcVideo::is_watched() {
  const Implementation& self = *implementation_;
  const Owned<GstMessage> message(gst_bus_pop_filtered(self.bus.get(), GST_MESSAGE_ERROR));
  if (message) {
    GError* raw = nullptr;
    gst_message_parse_error(message.get(), &raw, nullptr);
    const Owned<GError> error(raw);
    fail(error->message);
  }
  switch (property(self.peer.get(), "connection-state")) {
    case GST_WEBRTC_PEER_CONNECTION_STATE_CONNECTED:
      return true;
    case GST_WEBRTC_PEER_CONNECTION_STATE_NEW:
    case GST_WEBRTC_PEER_CONNECTION_STATE_CONNECTING:
      return monotonic_now_s() - self.begun_s < longest_connecting_s;
    default:
      return false;
  }
}

}  // namespace diminish
