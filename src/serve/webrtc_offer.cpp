#include "serve/webrtc_offer.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/text.h"
#include "diminish/error.h"

namespace diminish {
namespace {

const std::string& text_at(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) {
    throw Error(std::string("webrtc: ") + key + ": expected a text");
  }
  return found->get_ref<const std::string&>();
}

bool is_printable(std::string_view line) {
  return std::all_of(line.begin(), line.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

/// The number of "a=rtpmap:96 VP8/90000".
std::optional<int> vp8_number(std::string_view line) {
  constexpr std::string_view begin = "a=rtpmap:";
  constexpr std::string_view end = " VP8/90000";
  constexpr int most = 127;
  if (!line.starts_with(begin) || !line.ends_with(end)) return std::nullopt;
  if (line.size() <= begin.size() + end.size()) return std::nullopt;
  const std::string_view digits =
      line.substr(begin.size(), line.size() - begin.size() - end.size());
  int number = -1;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc{} || stop != digits.data() + digits.size()) return std::nullopt;
  return number >= 0 && number <= most ? std::optional(number) : std::nullopt;
}

/// Takes over the description line by line, without candidates.
void read_description(std::string_view sdp, WebRtcOffer& offer) {
  std::optional<int> vp8;
  int media = 0;
  bool has_fingerprint = false;
  bool has_credentials = false;
  while (!sdp.empty()) {
    const std::size_t end = std::min(sdp.find('\n'), sdp.size());
    std::string_view line = sdp.substr(0, end);
    sdp.remove_prefix(std::min(end + 1, sdp.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty()) continue;
    if (!is_printable(line)) throw Error("webrtc: sdp: expected printable ASCII");
    if (line.starts_with("a=candidate:") || line.starts_with("a=end-of-candidates") ||
        line.starts_with("a=remote-candidates:")) {
      continue;
    }
    if (line.starts_with("m=")) {
      if (++media > 1 || !line.starts_with("m=video ")) {
        throw Error("webrtc: sdp: expected one video and nothing else");
      }
    }
    if (!vp8) vp8 = vp8_number(line);
    has_fingerprint |= line.starts_with("a=fingerprint:");
    has_credentials |= line.starts_with("a=ice-ufrag:");
    offer.sdp.append(line).append("\r\n");
  }
  if (!offer.sdp.starts_with("v=0\r\n") || media == 0 || !has_fingerprint || !has_credentials) {
    throw Error("webrtc: sdp: expected a browser's offer of one video");
  }
  if (!vp8) throw Error("webrtc: sdp: expected VP8 among the viewer's codecs");
  offer.vp8_payload_type = *vp8;
}

}  // namespace

WebRtcOffer parse_webrtc_offer(const std::string& body) {
  const nlohmann::json json = nlohmann::json::parse(body, nullptr, false);
  if (!json.is_object()) throw Error(R"(webrtc: expected {"type": "offer", "sdp": "..."})");
  if (text_at(json, "type") != "offer") throw Error("webrtc: type: expected offer");
  WebRtcOffer offer;
  if (json.contains("view")) offer.view = parse_view(text_at(json, "view"));
  if (offer.view == View::pair) throw Error("webrtc: view: expected after or before");
  read_description(text_at(json, "sdp"), offer);
  return offer;
}

}  // namespace diminish
