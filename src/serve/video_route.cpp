#include <chrono>
#include <memory>
#include <string>

#include "diminish/camera_source.h"
#include "serve/access.h"
#include "serve/http.h"
#include "serve/json_answers.h"
#include "serve/web_routes.h"
#include "serve/webrtc_video.h"

namespace diminish {
namespace {

constexpr std::chrono::milliseconds frame_wait{200};
/// Every one of them compresses for itself.
constexpr std::size_t most_videos = 4;
/// So that a viewer whose machine is gone is noticed.
constexpr double heartbeat_s = 2;

/// Where viewers reach the server; empty: at all of this machine's addresses.
std::string video_address(const std::string& listened) {
  if (listened == "localhost") return "127.0.0.1";
  return listened == "0.0.0.0" || listened == "::" ? "" : listened;
}

}  // namespace

/// The video lasts as long as the request's answer: its first line has the session description,
/// then empty lines come until one of the two goes.
void WebRoutes::video(const httplib::Request& request, httplib::Response& response) {
  if (const std::string why = why_no_webrtc(); !why.empty()) return refuse(response, 501, why);
  const WebRtcOffer offer = parse_webrtc_offer(request.body);
  const auto viewer = admit(video_viewers_, most_videos, response);
  if (!viewer) return;
  const auto video = std::make_shared<WebRtcVideo>(offer, video_address(options_.address));
  response.set_header("Cache-Control", "no-store");
  response.set_chunked_content_provider(
      "application/x-ndjson", [this, viewer, video, number = std::size_t{0}, said_s = 0.0](
                                  std::size_t offset, httplib::DataSink& sink) mutable {
        const double now_s = monotonic_now_s();
        std::string line;
        if (offset == 0) {
          line = text_of({{"type", "answer"}, {"sdp", video->answer()}}) + "\n";
        } else if (now_s - said_s > heartbeat_s) {
          line = "\n";
        }
        if (!line.empty()) {
          said_s = now_s;
          if (!sink.write(line.data(), line.size())) return false;
        }
        try {
          if (stopped_ || !video->is_watched()) return false;
          const auto frame = session_.wait_for_frame(number, frame_wait);
          if (!frame) return true;
          number = frame->number;
          video->send(frame);
        } catch (const std::exception& error) {
          const std::string last = text_of({{"error", error.what()}}) + "\n";
          sink.write(last.data(), last.size());
          return false;
        }
        return true;
      });
}

}  // namespace diminish
