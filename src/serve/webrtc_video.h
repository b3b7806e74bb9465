#pragma once

#include <memory>
#include <string>

#include "diminish/live.h"
#include "serve/webrtc_offer.h"

namespace diminish {

/// Why this program cannot send a video: what it was built without, or which packages are not
/// installed. Empty if it can.
std::string why_no_webrtc();

/// The picture as a VP8 video to one viewer, encrypted, by GStreamer's webrtcbin. Has threads of
/// its own and compresses for this viewer alone: about a core at a million pixels.
class WebRtcVideo {
 public:
  /// Answers the offer. Takes up to some hundred milliseconds. The viewer reaches this machine at
  /// `address`, a number such as 127.0.0.1; empty: at any of its addresses. Throws Error.
  WebRtcVideo(const WebRtcOffer& offer, const std::string& address);
  ~WebRtcVideo();
  WebRtcVideo(const WebRtcVideo&) = delete;
  WebRtcVideo& operator=(const WebRtcVideo&) = delete;

  /// The answer, a session description with all candidates.
  const std::string& answer() const;
  /// Sends a frame's picture, without a copy. It carries the sensor's timestamp, as RTP's: 1/90000
  /// seconds of the monotonic clock, modulo 2^32. Returns at once; a frame that comes while others
  /// are compressed takes the place of the one that waits.
  void send(const std::shared_ptr<const LiveFrame>& frame);
  /// False once the viewer has left, or cannot be reached. Throws Error if compressing failed.
  bool is_watched();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
