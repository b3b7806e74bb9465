#include "serve/webrtc_video.h"

#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <regex>
#include <thread>

#include "chromium_offer.h"
#include "diminish/frame_source.h"
#include "diminish/web_server.h"
#include "expect_error.h"
#include "paths.h"
#include "serve/http.h"

namespace diminish {
namespace {

using nlohmann::json;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

const std::filesystem::path folder = std::filesystem::path(testing::recordings_dir()) / "calendar";

// That pictures arrive is tested with a browser (tests/page/video.test.js).
class VideoAnswer : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = why_no_webrtc(); !why.empty()) GTEST_SKIP() << why;
  }

  static json body() { return {{"type", "offer"}, {"sdp", testing::chromium_offer()}}; }

  /// The addresses at which an answer's candidates are.
  static std::vector<std::string> addresses(const std::string& sdp) {
    std::vector<std::string> found;
    const std::regex line(R"(a=candidate:\S+ \d+ \S+ \d+ (\S+) )");
    for (std::sregex_iterator i(sdp.begin(), sdp.end(), line), end; i != end; ++i) {
      found.push_back(i->str(1));
    }
    return found;
  }
};

TEST_F(VideoAnswer, IsOfferedAtTheGivenAddressOnly) {
  const WebRtcOffer offer = parse_webrtc_offer(body().dump());
  const WebRtcVideo video(offer, "127.0.0.1");
  EXPECT_THAT(video.answer(), HasSubstr("m=video 9 UDP/TLS/RTP/SAVPF 96\r\n"));
  EXPECT_THAT(video.answer(), HasSubstr("a=sendonly"));
  EXPECT_THAT(addresses(video.answer()), Not(::testing::IsEmpty()));
  EXPECT_THAT(addresses(video.answer()), Each("127.0.0.1"));
}

TEST_F(VideoAnswer, AnAddressMustBeANumber) {
  const WebRtcOffer offer = parse_webrtc_offer(body().dump());
  EXPECT_THAT(error_of([&] { WebRtcVideo(offer, "example.org"); }),
              HasSubstr("example.org: expected an address in numbers"));
}

TEST_F(VideoAnswer, IsServedToThoseWhoMayLook) {
  const Recording recording = load_recording(folder);
  const std::string replay = "recording:" + folder.string() + "?loop";
  LiveSession session(recording.rig, recording.scene, {}, {{"color", replay}, {"rgbd0", replay}},
                      {});
  const WebServer server(session, {.port = 0, .token = "sesame"});
  httplib::Client client("127.0.0.1", server.port());
  client.set_read_timeout(60);
  const auto post = [&](const char* path, const std::string& text, const std::string& origin) {
    return client.Post(path, {{"Origin", origin}}, text, "application/json");
  };
  const std::string own = "http://127.0.0.1:" + std::to_string(server.port());
  EXPECT_EQ(post("/api/webrtc", body().dump(), own)->status, 401);
  EXPECT_EQ(post("/api/webrtc?token=sesame", body().dump(), "http://evil.example")->status, 403);
  const auto wrong = post("/api/webrtc?token=sesame", R"({"type": "answer"})", own);
  EXPECT_EQ(wrong->status, 400);
  EXPECT_THAT(wrong->body, HasSubstr("expected offer"));
  EXPECT_EQ(json::parse(client.Get("/api/status?token=sesame")->body)["viewers"], 0);

  // The answer is the first line of a stream that lasts as long as the video is wanted.
  std::string line;
  httplib::Request request;
  request.method = "POST";
  request.path = "/api/webrtc?token=sesame";
  request.headers = {{"Content-Type", "application/json"}};
  request.body = body().dump();
  request.content_receiver = [&](const char* data, std::size_t size, std::uint64_t, std::uint64_t) {
    line.append(data, size);
    return line.find('\n') == std::string::npos;
  };
  client.send(request);
  ASSERT_THAT(line, HasSubstr("\n"));
  const json answer = json::parse(line.substr(0, line.find('\n')));
  EXPECT_EQ(answer["type"], "answer");
  EXPECT_THAT(addresses(answer["sdp"].get<std::string>()), Each("127.0.0.1"));

  // It has hung up, so the video ends.
  httplib::Client other("127.0.0.1", server.port());
  while (json::parse(other.Get("/api/status?token=sesame")->body)["viewers"] != 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace
}  // namespace diminish
