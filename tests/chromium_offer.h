#pragma once

#include <string>

namespace diminish::testing {

/// What Chromium 156 offers for one video to receive, with two of its codecs.
inline std::string chromium_offer() {
  return "v=0\r\n"
         "o=- 8727193373200904612 2 IN IP4 127.0.0.1\r\n"
         "s=-\r\n"
         "t=0 0\r\n"
         "a=group:BUNDLE 0\r\n"
         "a=extmap-allow-mixed\r\n"
         "a=msid-semantic: WMS\r\n"
         "m=video 9 UDP/TLS/RTP/SAVPF 96 97 102\r\n"
         "c=IN IP4 0.0.0.0\r\n"
         "a=rtcp:9 IN IP4 0.0.0.0\r\n"
         "a=ice-ufrag:nbUq\r\n"
         "a=ice-pwd:q8vKPxODFJj1gxonXmagouOg\r\n"
         "a=ice-options:trickle\r\n"
         "a=fingerprint:sha-256 "
         "40:F8:9B:4B:24:8B:2D:71:A3:D1:5B:CC:15:B8:40:D3:23:58:27:DA:5F:B9:25:5E:89:17:30:02:7F:"
         "C0:86:36\r\n"
         "a=setup:actpass\r\n"
         "a=mid:0\r\n"
         "a=extmap:4 http://www.ietf.org/id/draft-holmer-rmcat-transport-wide-cc-extensions-01\r\n"
         "a=extmap:9 urn:ietf:params:rtp-hdrext:sdes:mid\r\n"
         "a=recvonly\r\n"
         "a=rtcp-mux\r\n"
         "a=rtcp-rsize\r\n"
         "a=rtcp-xr:rcvr-rtt=all\r\n"
         "a=rtpmap:96 VP8/90000\r\n"
         "a=rtcp-fb:96 goog-remb\r\n"
         "a=rtcp-fb:96 transport-cc\r\n"
         "a=rtcp-fb:96 ccm fir\r\n"
         "a=rtcp-fb:96 nack\r\n"
         "a=rtcp-fb:96 nack pli\r\n"
         "a=rtpmap:97 rtx/90000\r\n"
         "a=fmtp:97 apt=96\r\n"
         "a=rtpmap:102 H264/90000\r\n"
         "a=rtcp-fb:102 goog-remb\r\n"
         "a=rtcp-fb:102 transport-cc\r\n"
         "a=rtcp-fb:102 ccm fir\r\n"
         "a=rtcp-fb:102 nack\r\n"
         "a=rtcp-fb:102 nack pli\r\n"
         "a=fmtp:102 level-asymmetry-allowed=1;packetization-mode=1;profile-level-id=42001f\r\n";
}

}  // namespace diminish::testing
