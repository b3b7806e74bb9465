#include "diminish/web_server.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "core/mat.h"
#include "diminish/frame_source.h"
#include "expect_error.h"
#include "paths.h"
#include "serve/http.h"
#include "serve/picture_stream.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using nlohmann::json;
using std::chrono::seconds;
using ::testing::HasSubstr;

const std::filesystem::path folder = std::filesystem::path(testing::recordings_dir()) / "calendar";

class Web : public ::testing::Test {
 protected:
  Web() { EXPECT_TRUE(session_.wait_for_frame(0, seconds(30))); }

  WebServerOptions options() const {
    WebServerOptions options;
    options.port = 0;
    options.recordings = recordings_.path();
    options.rig_file = folder / "rig.yaml";
    options.scene_file = folder / "scene.yaml";
    return options;
  }
  static httplib::Client client(const WebServer& server) {
    httplib::Client client("127.0.0.1", server.port());
    client.set_read_timeout(30);
    return client;
  }
  static json post(const WebServer& server, const char* path, const json& body, int status = 200) {
    const auto response = client(server).Post(path, body.dump(), "application/json");
    if (!response) throw std::runtime_error("no answer");
    EXPECT_EQ(response->status, status) << response->body;
    return json::parse(response->body);
  }
  static json get(const WebServer& server, const char* path) {
    const auto response = client(server).Get(path);
    if (!response) throw std::runtime_error("no answer");
    return json::parse(response->body);
  }

  /// The first `count` JPEGs of the stream, with their frames' numbers.
  static std::vector<std::pair<std::size_t, cv::Mat>> stream(const WebServer& server,
                                                             std::size_t count,
                                                             const std::string& view) {
    std::vector<std::pair<std::size_t, cv::Mat>> pictures;
    PictureStream streamed;
    client(server).Get("/api/stream.mjpg?view=" + view, [&](const char* data, std::size_t size) {
      streamed.feed(data, size);
      while (pictures.size() < count) {
        const auto next = streamed.next();
        if (!next) return true;
        pictures.emplace_back(next->frame, cv::imdecode(next->jpeg, cv::IMREAD_COLOR));
      }
      return false;
    });
    return pictures;
  }

  TemporaryFolder recordings_;
  Recording recording_ = load_recording(folder);
  std::string replay_ = "recording:" + folder.string() + "?loop";
  LiveSession session_{
      recording_.rig, recording_.scene, {}, {{"color", replay_}, {"rgbd0", replay_}}, {}};
};

TEST_F(Web, ServesThePage) {
  const WebServer server(session_, options());
  for (const char* path : {"/", "/viewer.js", "/stream.js", "/style.css"}) {
    const auto response = client(server).Get(path);
    ASSERT_TRUE(response);
    EXPECT_EQ(response->status, 200) << path;
    EXPECT_FALSE(response->body.empty());
  }
  EXPECT_EQ(client(server).Get("/nothing")->status, 404);
}

TEST_F(Web, StatusIsTheSessions) {
  const WebServer server(session_, options());
  const json status = get(server, "/api/status");
  EXPECT_GT(status["frames"], 0);
  EXPECT_EQ(status["cameras"].size(), 2U);
  EXPECT_EQ(status["cameras"][0]["state"], "running");
  EXPECT_EQ(status["stage_ms"].size(), stage_count);
  EXPECT_EQ(status["objects"][0]["name"], "calendar");
  EXPECT_EQ(status["objects"][0]["in_color"], true);
}

TEST_F(Web, StreamsPicturesThatMoveOn) {
  const WebServer server(session_, options());
  const auto pictures = stream(server, 4, "after");
  ASSERT_EQ(pictures.size(), 4U);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    EXPECT_EQ(pictures[i].second.cols, recording_.rig.color.width);
    EXPECT_EQ(pictures[i].second.rows, recording_.rig.color.height);
    EXPECT_TRUE(i == 0 || pictures[i].first > pictures[i - 1].first);
  }
}

TEST_F(Web, APairShowsTheCamerasPictureAboveTheResult) {
  const WebServer server(session_, options());
  const cv::Mat pair = stream(server, 1, "pair").at(0).second;
  const int height = recording_.rig.color.height;
  ASSERT_EQ(pair.rows, 2 * height);
  const cv::Mat before = pair.rowRange(0, height);
  const cv::Mat after = pair.rowRange(height, 2 * height);
  cv::Mat difference;
  cv::absdiff(before, after, difference);
  EXPECT_GT(cv::mean(difference)[0], 0.5);
  // They differ where the object is, and are the same frame elsewhere.
  EXPECT_LT(cv::mean(difference(cv::Rect(0, 0, 200, 200)))[0], 3);
}

TEST_F(Web, APngIsTheResultWithoutLoss) {
  const WebServer server(session_, options());
  session_.stop();
  const auto response = client(server).Get("/api/frame.png");
  ASSERT_TRUE(response);
  ASSERT_EQ(response->status, 200);
  const cv::Mat picture = cv::imdecode(
      std::vector<char>(response->body.begin(), response->body.end()), cv::IMREAD_COLOR);
  const auto last = session_.wait_for_frame(0, seconds(1));
  EXPECT_EQ(cv::norm(picture, as_mat(last->result.picture), cv::NORM_INF), 0);
}

TEST_F(Web, EventsComeAgainAndAgain) {
  const WebServer server(session_, options());
  std::string text;
  client(server).Get("/api/events", [&](const char* data, std::size_t size) {
    text.append(data, size);
    return std::count(text.begin(), text.end(), '\n') < 6;
  });
  const std::size_t second = text.find("\n\ndata: ") + 2;
  const json event = json::parse(text.substr(second + 6, text.find('\n', second) - second - 6));
  EXPECT_EQ(event["running"], true);
}

TEST_F(Web, SettingsChangeTheSession) {
  const WebServer server(session_, options());
  const json settings = post(server, "/api/settings", {{"mode", "outline"}, {"budget_ms", 50}});
  EXPECT_EQ(session_.options().mode, "outline");
  EXPECT_EQ(session_.live_options().budget_ms, 50);
  EXPECT_EQ(settings["objects"], json({"calendar"}));
  EXPECT_EQ(get(server, "/api/settings"), settings);
}

TEST_F(Web, WrongSettingsAreRefusedWithTheReason) {
  const WebServer server(session_, options());
  const auto complaint = [&](const json& body) -> std::string {
    return post(server, "/api/settings", body, 400)["error"];
  };
  EXPECT_THAT(complaint({{"mode", "sideways"}}), HasSubstr("mode: expected one of"));
  EXPECT_THAT(complaint({{"mask_margin_px", -5}}), HasSubstr("mask_margin_px: expected 0 to"));
  EXPECT_THAT(complaint({{"keep", "teapot"}}), HasSubstr("'teapot'"));
  EXPECT_THAT(complaint({{"mode", "half"}, {"what", 1}}), HasSubstr("'what'"));
  EXPECT_EQ(session_.options().mode, "remove") << "all or nothing";
  EXPECT_EQ(client(server).Get("/api/stream.mjpg?view=up")->status, 400);
}

TEST_F(Web, TooManyViewersAreAskedToComeBack) {
  WebServerOptions few = options();
  few.most_viewers = 1;
  const WebServer server(session_, few);
  std::atomic<bool> first_looks = false;
  std::atomic<bool> first_may_go = false;
  std::thread first([&] {
    client(server).Get("/api/stream.mjpg", [&](const char*, std::size_t) {
      first_looks = true;
      return !first_may_go;
    });
  });
  while (!first_looks) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const auto refused = client(server).Get("/api/stream.mjpg");
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->status, 503);
  EXPECT_THAT(refused->body, HasSubstr("already 1 viewers"));
  first_may_go = true;
  first.join();
}

TEST_F(Web, AViewerWhoDoesNotReadHoldsNobodyUp) {
  const WebServer server(session_, options());
  std::atomic<bool> stuck = false;
  std::atomic<bool> may_go = false;
  std::thread slow([&] {
    client(server).Get("/api/stream.mjpg", [&](const char*, std::size_t) {
      stuck = true;
      while (!may_go) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      return false;
    });
  });
  while (!stuck) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const std::size_t before = session_.status().frames;
  const auto pictures = stream(server, 5, "after");
  EXPECT_EQ(pictures.size(), 5U);
  EXPECT_GE(session_.status().frames, before + 4);
  may_go = true;
  slow.join();
}

bool has_depth_image(const std::filesystem::path& recording) {
  std::error_code not_yet_there;
  const std::filesystem::directory_iterator images(recording / "rgbd0" / "depth", not_yet_there);
  return images != std::filesystem::directory_iterator();
}

TEST_F(Web, RecordsOnRequest) {
  const WebServer server(session_, options());
  while (get(server, "/api/status")["posed"] != json({true})) {  // its camera is there
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const json started = post(server, "/api/recording", {{"active", true}});
  EXPECT_EQ(started["active"], true);
  const std::filesystem::path made = started["folder"].get<std::string>();
  EXPECT_EQ(made.parent_path(), recordings_.path());
  EXPECT_THAT(post(server, "/api/recording", {{"active", true}}, 400)["error"].get<std::string>(),
              HasSubstr("already"));
  // On a busy machine the first frames may come without their depth.
  while (get(server, "/api/status")["recording"]["frames"] < 3 || !has_depth_image(made)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const json ended = post(server, "/api/recording", {{"active", false}});
  EXPECT_EQ(ended["active"], false);
  EXPECT_EQ(ended["problem"], "");
  const Recording recorded = load_recording(made);
  // On a busy machine the cameras' images are far apart.
  Options matching;
  matching.sync_tolerance_s = 60;
  const auto source = open_recording(recorded, matching);
  EXPECT_EQ(source->frame_count(), ended["frames"]);
  bool has_depth = false;
  for (FrameSet frame; source->next(frame);) has_depth = has_depth || frame.rgbd[0].available();
  EXPECT_TRUE(has_depth);
}

/// Files of a recording that nobody takes: whoever writes to a pipe waits for a reader.
class StuckDisk {
 public:
  explicit StuckDisk(const std::filesystem::path& recording) {
    constexpr int most = 200;
    for (int i = 0; i < most; ++i) {
      const auto pipe = recording / "color" / fmt::format(".{:06}.partial.jpg", i);
      if (mkfifo(pipe.c_str(), S_IRUSR | S_IWUSR) == 0) pipes_.push_back(pipe);
    }
  }
  /// Takes what comes until `is_done`.
  template <class Condition>
  void take_all(const Condition& is_done) const {
    std::vector<int> readers;
    for (const auto& pipe : pipes_) readers.push_back(open(pipe.c_str(), O_RDONLY | O_NONBLOCK));
    std::vector<char> taken(1 << 16);
    while (!is_done()) {
      for (const int reader : readers) {
        while (read(reader, taken.data(), taken.size()) > 0) {
        }
      }
    }
    for (const int reader : readers) close(reader);
  }

 private:
  std::vector<std::filesystem::path> pipes_;
};

TEST_F(Web, NobodyWaitsForARecordingThatCannotEnd) {
  const WebServer server(session_, options());
  const json started = post(server, "/api/recording", {{"active", true}});
  const StuckDisk disk(started["folder"].get<std::string>());
  const auto dropped = [&] {
    return get(server, "/api/status")["recording"]["dropped"].get<std::size_t>();
  };
  while (dropped() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::atomic<bool> has_ended = false;
  std::thread ending([&] {
    httplib::Client patient("127.0.0.1", server.port());
    patient.set_read_timeout(seconds(600));
    const auto answer = patient.Post("/api/recording", R"({"active": false})", "application/json");
    has_ended = true;
    EXPECT_TRUE(answer && answer->status == 200);
  });
  // Until it gets no more frames.
  for (std::size_t before = 0; before != dropped();) {
    before = dropped();
    const std::size_t frames = session_.status().frames;
    while (session_.status().frames < frames + 3) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  EXPECT_FALSE(has_ended);
  disk.take_all([&] { return has_ended.load(); });
  ending.join();
}

TEST_F(Web, RecordsNothingUnlessAllowed) {
  WebServerOptions none = options();
  none.recordings.clear();
  const WebServer server(session_, none);
  EXPECT_THAT(post(server, "/api/recording", {{"active", true}}, 400)["error"].get<std::string>(),
              HasSubstr("--recordings"));
  EXPECT_THAT(post(server, "/api/recording", {{"on", true}}, 400)["error"].get<std::string>(),
              HasSubstr("expected {\"active\": true}"));
}

TEST_F(Web, SaysWhatIsRememberedAndForgetsOnRequest) {
  const WebServer server(session_, options());
  post(server, "/api/settings", {{"memory", "on"}});
  const auto wait_for_memory = [&](const auto& is_there) {
    while (true) {
      json status = get(server, "/api/status");
      if (is_there(status["memory"]["keyframes"].get<int>())) return status;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  };
  const json status = wait_for_memory([](int keyframes) { return keyframes > 2; });
  EXPECT_GT(status["memory"]["megabytes"], 3);
  EXPECT_THAT(status["evidence"].get<std::string>(), HasSubstr("truly seen "));
  EXPECT_NEAR(status["seen_share"].get<double>() + status["remembered_share"].get<double>() +
                  status["estimated_share"].get<double>() + status["invented_share"].get<double>(),
              1, 0.02);
  EXPECT_EQ(post(server, "/api/memory", {{"forget", true}}).count("keyframes"), 1U);
  wait_for_memory([](int keyframes) { return keyframes <= 2; });
  EXPECT_THAT(post(server, "/api/memory", {{"forget", "it"}}, 400)["error"].get<std::string>(),
              HasSubstr("expected {\"forget\": true}"));
}

TEST_F(Web, RefusesOtherSites) {
  const WebServer server(session_, options());
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "[::1].evil.example"}) {
    EXPECT_EQ(client(server).Get("/api/status", {{"Host", host}})->status, 403) << host;
    EXPECT_EQ(client(server).Get("/", {{"Host", host}})->status, 403) << host;
  }
  const std::string own = "127.0.0.1:" + std::to_string(server.port());
  const auto status_from = [&](const std::string& origin) {
    return client(server).Get("/api/status", {{"Host", own}, {"Origin", origin}})->status;
  };
  EXPECT_EQ(status_from("http://" + own), 200);
  EXPECT_EQ(status_from("http://" + own + ".evil.example"), 403);
  EXPECT_EQ(status_from("null"), 403);
  const auto form = client(server).Post("/api/settings", R"({"mode":"half"})", "text/plain");
  EXPECT_EQ(form->status, 415);
  EXPECT_EQ(session_.options().mode, "remove");
}

TEST_F(Web, WithATokenNothingIsToldWithoutIt) {
  WebServerOptions secret = options();
  secret.token = "sesame";
  const WebServer server(session_, secret);
  EXPECT_THAT(server.url(), HasSubstr("?token=sesame"));
  for (const char* path : {"/api/status", "/api/frame.jpg", "/api/stream.mjpg", "/api/events",
                           "/api/settings", "/api/status?token=sesam"}) {
    EXPECT_EQ(client(server).Get(path)->status, 401) << path;
  }
  EXPECT_EQ(client(server).Get("/api/status?token=sesame")->status, 200);
  EXPECT_EQ(client(server).Get("/api/status", {{"Authorization", "Bearer sesame"}})->status, 200);
}

TEST_F(Web, ACookieKeepsTheTokenOutOfAddresses) {
  WebServerOptions secret = options();
  secret.token = "sesame";
  const WebServer server(session_, secret);
  EXPECT_FALSE(client(server).Get("/?token=sesam")->has_header("Set-Cookie"));
  const auto first = client(server).Get("/?token=sesame");
  EXPECT_EQ(first->status, 303);
  EXPECT_EQ(first->get_header_value("Location"), "/");
  const std::string set = first->get_header_value("Set-Cookie");
  EXPECT_THAT(set, HasSubstr("; HttpOnly; SameSite=Strict"));
  const std::string cookie = set.substr(0, set.find(';'));
  EXPECT_EQ(client(server).Get("/api/status", {{"Cookie", cookie}})->status, 200);
  EXPECT_EQ(client(server).Get("/api/status", {{"Cookie", cookie + "x"}})->status, 401);
}

TEST_F(Web, ForbidsOtherPagesToShowIt) {
  const WebServer server(session_, options());
  for (const char* path : {"/", "/api/status", "/viewer.js", "/missing"}) {
    const auto answer = client(server).Get(path);
    EXPECT_THAT(answer->get_header_value("Content-Security-Policy"),
                HasSubstr("frame-ancestors 'none'"))
        << path;
    EXPECT_EQ(answer->get_header_value("X-Content-Type-Options"), "nosniff") << path;
    EXPECT_EQ(answer->get_header_value("Cross-Origin-Resource-Policy"), "same-origin") << path;
  }
}

TEST_F(Web, AnOpenAddressNeedsAToken) {
  WebServerOptions open = options();
  open.address = "0.0.0.0";
  EXPECT_THAT(error_of([&] { WebServer(session_, open); }), HasSubstr("needs a token"));
}

TEST_F(Web, APortThatIsTakenIsAnError) {
  const WebServer first(session_, options());
  WebServerOptions same = options();
  same.port = first.port();
  EXPECT_THAT(error_of([&] { WebServer(session_, same); }), HasSubstr("cannot listen"));
}

}  // namespace
}  // namespace diminish
