#include "diminish/error.h"
#include "serve/webrtc_video.h"

namespace diminish {

struct WebRtcVideo::Implementation {
  std::string answer;
};

std::string why_no_webrtc() {
  return "video: expected a program that was built with GStreamer's WebRTC library "
         "(libgstreamer-plugins-bad1.0-dev)";
}

WebRtcVideo::WebRtcVideo(const WebRtcOffer&, const std::string&) {
  throw Error(why_no_webrtc());
}
WebRtcVideo::~WebRtcVideo() = default;
const std::string& WebRtcVideo::answer() const {
  return implementation_->answer;
}
void WebRtcVideo::send(const std::shared_ptr<const LiveFrame>&) {}
bool WebRtcVideo::is_watched() {
  return false;
}

}  // namespace diminish
