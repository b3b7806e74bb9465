#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

#include "diminish/live.h"
#include "diminish/recording_writer.h"
#include "diminish/web_server.h"
#include "serve/picture_encoder.h"

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace diminish {

/// What the web server answers (docs/http-api.md), and whom. Knows no sockets.
class WebRoutes {
 public:
  /// Throws Error if the address is one that others can reach and there is no token.
  WebRoutes(LiveSession& session, const WebServerOptions& options);
  /// Ends the recording.
  ~WebRoutes();
  WebRoutes(const WebRoutes&) = delete;
  WebRoutes& operator=(const WebRoutes&) = delete;

  /// The server must not outlive this.
  void add_to(httplib::Server& server);
  /// Before the first request.
  void listens_at(int port) { port_ = port; }
  /// Ends all streams.
  void stop() { stopped_ = true; }

 private:
  /// Counts a viewer of a stream for as long as it lives.
  class Viewer {
   public:
    Viewer(std::atomic<std::size_t>& count, std::size_t most) : count_(count) {
      welcome_ = count_.fetch_add(1) < most;
    }
    ~Viewer() { --count_; }
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;
    bool welcome() const { return welcome_; }

   private:
    std::atomic<std::size_t>& count_;
    bool welcome_;
  };

  /// Browsers send a host's cookies to all of its ports.
  std::string cookie_name() const { return "diminish-" + std::to_string(port_); }
  std::string given_token(const httplib::Request& request) const;
  /// Whether the request may go on; if not, it has been answered.
  bool check_access(const httplib::Request& request, httplib::Response& response) const;
  /// Adds a viewer; answers with a refusal and returns nullptr if there are too many.
  std::shared_ptr<Viewer> admit(std::atomic<std::size_t>& viewers, std::size_t most,
                                httplib::Response& response) const;
  void stream(const httplib::Request& request, httplib::Response& response);
  void picture(const httplib::Request& request, httplib::Response& response, bool is_png);
  void events(httplib::Response& response);
  void video(const httplib::Request& request, httplib::Response& response);
  void change_settings(const httplib::Request& request, httplib::Response& response);
  void change_recording(const httplib::Request& request, httplib::Response& response);
  void change_memory(const httplib::Request& request, httplib::Response& response);
  void start_recording();
  void stop_recording();
  nlohmann::ordered_json status_json();

  LiveSession& session_;
  WebServerOptions options_;
  PictureEncoder encoder_;
  int port_ = 0;
  std::atomic<bool> stopped_ = false;
  std::atomic<std::size_t> picture_viewers_ = 0, video_viewers_ = 0, event_viewers_ = 0;
  std::mutex settings_mutex_;  ///< serialises changes
  std::mutex recording_mutex_;
  std::shared_ptr<RecordingWriter> recording_;
  std::shared_ptr<void> recording_listener_;
};

}  // namespace diminish
