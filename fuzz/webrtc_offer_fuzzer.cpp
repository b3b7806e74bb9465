#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "diminish/error.h"
#include "serve/webrtc_offer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const diminish::WebRtcOffer offer =
        diminish::parse_webrtc_offer(std::string(reinterpret_cast<const char*>(data), size));
    // What it promises to GStreamer: no address of others, and nothing but lines of text.
    if (offer.sdp.find("\na=candidate:") != std::string::npos) std::abort();
    for (const char c : offer.sdp) {
      if (c != '\r' && c != '\n' && (c < ' ' || c > '~')) std::abort();
    }
    if (offer.vp8_payload_type < 0 || offer.vp8_payload_type > 127) std::abort();
  } catch (const diminish::Error&) {
  }
  return 0;
}
