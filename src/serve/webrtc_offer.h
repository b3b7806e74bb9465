#pragma once

#include <string>

#include "serve/picture_encoder.h"

namespace diminish {

/// What a viewer sends to POST /api/webrtc: it wants the picture as a video.
struct WebRtcOffer {
  /// Its session description, without candidates: a viewer makes itself known by its first packet,
  /// so nothing is ever sent to an address that only stands in a request.
  std::string sdp;
  View view = View::after;   ///< `after` or `before`
  int vp8_payload_type = 0;  ///< how the viewer numbers VP8
};

/// Reads `{"type": "offer", "sdp": "v=0...", "view": "after"}`. Throws Error, which says what was
/// expected.
WebRtcOffer parse_webrtc_offer(const std::string& body);

}  // namespace diminish
