#include "serve/webrtc_offer.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "chromium_offer.h"
#include "diminish/error.h"
#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

std::string body(const std::string& sdp, const std::string& type = "offer") {
  return nlohmann::json{{"type", type}, {"sdp", sdp}}.dump();
}
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(WebRtcOffer, ReadsABrowsers) {
  const WebRtcOffer offer = parse_webrtc_offer(body(testing::chromium_offer()));
  EXPECT_EQ(offer.vp8_payload_type, 96);
  EXPECT_EQ(offer.view, View::after);
  EXPECT_EQ(offer.sdp, testing::chromium_offer());
  const nlohmann::json before = {
      {"type", "offer"}, {"sdp", testing::chromium_offer()}, {"view", "before"}};
  EXPECT_EQ(parse_webrtc_offer(before.dump()).view, View::before);
}

// Whoever may look must not make this machine send packets elsewhere.
TEST(WebRtcOffer, AddressesInItAreDropped) {
  const std::string with =
      testing::chromium_offer() +
      "a=candidate:1 1 udp 2113937151 192.0.2.7 53 typ host\r\n"
      "a=candidate:2 1 tcp 1 victim.local 80 typ host tcptype passive\r\na=end-of-candidates\r\n"
      "a=remote-candidates:1 192.0.2.7 53\r\n";
  EXPECT_EQ(parse_webrtc_offer(body(with)).sdp, testing::chromium_offer());
}

TEST(WebRtcOffer, LineEndsMayBeUnix) {
  std::string unix_lines = testing::chromium_offer();
  std::erase(unix_lines, '\r');
  EXPECT_EQ(parse_webrtc_offer(body(unix_lines)).sdp, testing::chromium_offer());
}

TEST(WebRtcOffer, WhatIsNoneIsRefusedWithTheReason) {
  const auto complaint = [](const std::string& text) {
    return error_of([&] { parse_webrtc_offer(text); });
  };
  const std::string sdp = testing::chromium_offer();
  EXPECT_THAT(complaint("v=0"), HasSubstr(R"(expected {"type": "offer")"));
  EXPECT_THAT(complaint("[]"), HasSubstr(R"(expected {"type": "offer")"));
  EXPECT_THAT(complaint(R"({"type": "offer"})"), HasSubstr("sdp: expected a text"));
  EXPECT_THAT(complaint(R"({"type": "offer", "sdp": 3})"), HasSubstr("sdp: expected a text"));
  EXPECT_THAT(complaint(body(sdp, "answer")), HasSubstr("type: expected offer"));
  EXPECT_THAT(complaint(R"({"type": "offer", "sdp": "", "view": "pair"})"),
              HasSubstr("view: expected after or before"));
  EXPECT_THAT(complaint(body("")), HasSubstr("expected a browser's offer"));
  EXPECT_THAT(complaint(body(sdp + "m=audio 9 UDP/TLS/RTP/SAVPF 111\r\n")),
              HasSubstr("one video and nothing else"));
  EXPECT_THAT(complaint(body(sdp + "m=video 9 UDP/TLS/RTP/SAVPF 96\r\n")),
              HasSubstr("one video and nothing else"));
  EXPECT_THAT(complaint(body(replaced(sdp, "a=fingerprint:", "a=x-fingerprint:"))),
              HasSubstr("expected a browser's offer"));
  EXPECT_THAT(complaint(body(replaced(sdp, "VP8/90000", "VP8/9000"))), HasSubstr("expected VP8"));
  EXPECT_THAT(complaint(body(replaced(sdp, "rtpmap:96 VP8", "rtpmap:128 VP8"))),
              HasSubstr("expected VP8"));
  EXPECT_THAT(complaint(body(sdp + "a=x:\x01\r\n")), HasSubstr("printable ASCII"));
}

}  // namespace
}  // namespace diminish
