#include "diminish/web_server.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <httplib.h>
#include <sys/resource.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "diminish/error.h"
#include "diminish/recording_writer.h"
#include "page_files.h"
#include "serve/access.h"
#include "serve/picture_encoder.h"
#include "serve/settings.h"
#include "serve/status_json.h"

namespace diminish {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;

constexpr milliseconds picture_wait{500};
constexpr milliseconds event_period{200};
constexpr int write_timeout_s = 5;
constexpr std::size_t most_request_bytes = 1 << 16;

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void answer(httplib::Response& response, const Json& json, int status = 200) {
  response.status = status;
  response.set_header("Cache-Control", "no-store");
  response.set_content(text_of(json), "application/json");
}
void refuse(httplib::Response& response, int status, const std::string& why) {
  answer(response, {{"error", why}}, status);
}

/// What a browser may do with an answer: show it in this program's own page, with nothing from
/// elsewhere.
httplib::Headers page_rules() {
  return {{"Content-Security-Policy",
           "default-src 'self'; img-src 'self' blob: data:; base-uri 'none'; form-action 'none'; "
           "frame-ancestors 'none'"},
          {"X-Content-Type-Options", "nosniff"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Referrer-Policy", "no-referrer"}};
}

std::string content_type(const std::string& file) {
  if (file.ends_with(".html")) return "text/html; charset=utf-8";
  if (file.ends_with(".css")) return "text/css; charset=utf-8";
  return "text/javascript; charset=utf-8";
}

View requested_view(const httplib::Request& request) {
  return parse_view(request.has_param("view") ? request.get_param_value("view") : "after");
}

/// Compressing pictures must not slow down making them.
void lower_priority_of_this_thread() {
  constexpr int nice = 5;
  thread_local const int done = setpriority(PRIO_PROCESS, 0, nice);
  (void)done;
}

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

}  // namespace

struct WebServer::Implementation {
  Implementation(LiveSession& session_, const WebServerOptions& options_)
      : session(session_), options(options_), encoder(options_.jpeg_quality) {
    if (!is_loopback(options.address) && options.token.empty()) {
      throw Error(options.address + ": an address that others can reach needs a token");
    }
    if (!is_token(options.token)) {
      throw Error("token: expected letters, digits, '-', '.', '_' and '~' only");
    }
    // One thread for each viewer's pictures, one for its events, and some for short requests.
    const std::size_t threads = 2 * options.most_viewers + 8;
    server.new_task_queue = [threads] { return new httplib::ThreadPool(threads); };
    // Not SO_REUSEPORT, which would let two programs share a port without noticing.
    server.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server.set_tcp_nodelay(true);
    server.set_keep_alive_max_count(1000);
    server.set_keep_alive_timeout(1);
    server.set_write_timeout(write_timeout_s);
    server.set_payload_max_length(most_request_bytes);
    server.set_default_headers(page_rules());
    add_routes();
    if (options.port == 0) {
      port = server.bind_to_any_port(options.address);
    } else if (server.bind_to_port(options.address, options.port)) {
      port = options.port;
    }
    if (port <= 0) {
      throw Error(fmt::format("{}:{}: cannot listen; is another program using the port?",
                              options.address, options.port));
    }
    listener = std::thread([this] { server.listen_after_bind(); });
    while (!server.is_running()) std::this_thread::sleep_for(milliseconds(1));
  }

  ~Implementation() {
    stopped = true;
    server.stop();
    listener.join();
    stop_recording();
  }

  void add_routes();
  /// Browsers send a host's cookies to all of its ports.
  std::string cookie_name() const { return fmt::format("diminish-{}", port); }
  std::string given_token(const httplib::Request& request) const;
  httplib::Server::HandlerResponse check_access(const httplib::Request& request,
                                                httplib::Response& response) const;
  /// Adds a viewer; answers with a refusal and returns nullptr if there are too many.
  std::shared_ptr<Viewer> admit(std::atomic<std::size_t>& viewers,
                                httplib::Response& response) const;
  void stream(const httplib::Request& request, httplib::Response& response);
  void picture(const httplib::Request& request, httplib::Response& response, bool is_png);
  void events(httplib::Response& response);
  void change_settings(const httplib::Request& request, httplib::Response& response);
  void change_recording(const httplib::Request& request, httplib::Response& response);
  void change_memory(const httplib::Request& request, httplib::Response& response);
  void start_recording();
  void stop_recording();
  Json status_json();

  LiveSession& session;
  WebServerOptions options;
  PictureEncoder encoder;
  httplib::Server server;
  int port = 0;
  std::atomic<bool> stopped = false;
  std::atomic<std::size_t> picture_viewers = 0, event_viewers = 0;
  std::mutex settings_mutex;  ///< serialises changes
  std::mutex recording_mutex;
  std::shared_ptr<RecordingWriter> recording;
  std::shared_ptr<void> recording_listener;
  std::thread listener;
};

void WebServer::Implementation::add_routes() {
  server.set_pre_routing_handler([this](const auto& request, auto& response) {
    lower_priority_of_this_thread();
    return check_access(request, response);
  });
  server.set_exception_handler([](const auto&, auto& response, const std::exception_ptr& error) {
    try {
      std::rethrow_exception(error);
    } catch (const Error& wrong) {
      refuse(response, 400, wrong.what());
    } catch (const std::exception& failure) {
      refuse(response, 500, failure.what());
    } catch (...) {
      refuse(response, 500, "an unknown error");
    }
  });
  for (const auto& [name, content] : page_files()) {
    const std::string path = name == "index.html" ? "/" : "/" + name;
    server.Get(path, [name = name, content = content](const auto&, auto& response) {
      response.set_header("Cache-Control", "no-cache");
      response.set_content(std::string(content), content_type(name));
    });
  }
  server.Get("/api/stream.mjpg",
             [this](const auto& request, auto& response) { stream(request, response); });
  server.Get("/api/frame.jpg",
             [this](const auto& request, auto& response) { picture(request, response, false); });
  server.Get("/api/frame.png",
             [this](const auto& request, auto& response) { picture(request, response, true); });
  server.Get("/api/status",
             [this](const auto&, auto& response) { answer(response, status_json()); });
  server.Get("/api/events", [this](const auto&, auto& response) { events(response); });
  server.Get("/api/settings",
             [this](const auto&, auto& response) { answer(response, describe_settings(session)); });
  server.Post("/api/settings",
              [this](const auto& request, auto& response) { change_settings(request, response); });
  server.Post("/api/memory",
              [this](const auto& request, auto& response) { change_memory(request, response); });
  server.Post("/api/recording",
              [this](const auto& request, auto& response) { change_recording(request, response); });
}

std::string WebServer::Implementation::given_token(const httplib::Request& request) const {
  const std::string bearer = "Bearer ";
  const std::string header = request.get_header_value("Authorization");
  if (header.starts_with(bearer)) return header.substr(bearer.size());
  if (request.has_param("token")) return request.get_param_value("token");
  return cookie_of(request.get_header_value("Cookie"), cookie_name());
}

httplib::Server::HandlerResponse WebServer::Implementation::check_access(
    const httplib::Request& request, httplib::Response& response) const {
  const auto handled = httplib::Server::HandlerResponse::Handled;
  const std::string host = request.get_header_value("Host");
  if (!is_same_site(request.get_header_value("Origin"), host)) {
    refuse(response, 403, "Origin: expected this program's own page");
    return handled;
  }
  if (options.token.empty()) {
    if (!names_loopback(host)) {
      refuse(response, 403, "Host: expected this machine's own name, such as localhost");
      return handled;
    }
  } else {
    const bool has_token = equals_secretly(given_token(request), options.token);
    // The page's own files hold no secrets.
    if (request.path.starts_with("/api/") && !has_token) {
      refuse(response, 401, "expected the token that diminish printed when it started");
      return handled;
    }
    // From the first visit on a cookie holds the token: no history and no log then does.
    if (request.path == "/" && request.has_param("token") && has_token) {
      response.set_header("Set-Cookie", fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/",
                                                    cookie_name(), options.token));
      response.set_redirect("/", 303);
      return handled;
    }
  }
  // A form on another site can send a request without asking, but not as JSON.
  if (request.method == "POST" &&
      !request.get_header_value("Content-Type").starts_with("application/json")) {
    refuse(response, 415, "Content-Type: expected application/json");
    return handled;
  }
  return httplib::Server::HandlerResponse::Unhandled;
}

std::shared_ptr<Viewer> WebServer::Implementation::admit(std::atomic<std::size_t>& viewers,
                                                         httplib::Response& response) const {
  auto viewer = std::make_shared<Viewer>(viewers, options.most_viewers);
  if (viewer->welcome()) return viewer;
  refuse(response, 503, fmt::format("already {} viewers", options.most_viewers));
  return nullptr;
}

void WebServer::Implementation::stream(const httplib::Request& request,
                                       httplib::Response& response) {
  const View view = requested_view(request);
  const auto viewer = admit(picture_viewers, response);
  if (!viewer) return;
  response.set_header("Cache-Control", "no-store");
  response.set_chunked_content_provider(
      "multipart/x-mixed-replace; boundary=picture",
      [this, view, viewer, number = std::size_t{0}](std::size_t, httplib::DataSink& sink) mutable {
        if (stopped) return false;
        const auto frame = session.wait_for_frame(number, picture_wait);
        if (!frame) return sink.is_writable();
        number = frame->number;
        const PictureEncoder::Bytes jpeg = encoder.jpeg(*frame, view);
        const std::string head = fmt::format(
            "--picture\r\nContent-Type: image/jpeg\r\nContent-Length: {}\r\nX-Frame: {}\r\n"
            "X-Stamp: {:.6f}\r\n\r\n",
            jpeg->size(), number, frame->input.stamp_s);
        return sink.write(head.data(), head.size()) &&
               sink.write(reinterpret_cast<const char*>(jpeg->data()), jpeg->size()) &&
               sink.write("\r\n", 2);
      });
}

void WebServer::Implementation::picture(const httplib::Request& request,
                                        httplib::Response& response, bool is_png) {
  const View view = requested_view(request);
  const auto frame = session.wait_for_frame(0, picture_wait);
  if (!frame) return refuse(response, 503, "there is no picture yet");
  response.set_header("Cache-Control", "no-store");
  response.set_header("X-Frame", std::to_string(frame->number));
  if (is_png) {
    const auto bytes = encoder.png(*frame, view);
    response.set_content(reinterpret_cast<const char*>(bytes.data()), bytes.size(), "image/png");
  } else {
    const auto bytes = encoder.jpeg(*frame, view);
    response.set_content(reinterpret_cast<const char*>(bytes->data()), bytes->size(), "image/jpeg");
  }
}

void WebServer::Implementation::events(httplib::Response& response) {
  const auto viewer = admit(event_viewers, response);
  if (!viewer) return;
  response.set_header("Cache-Control", "no-store");
  response.set_chunked_content_provider(
      "text/event-stream", [this, viewer](std::size_t offset, httplib::DataSink& sink) {
        if (stopped) return false;
        if (offset > 0) std::this_thread::sleep_for(event_period);
        const std::string event = "data: " + text_of(status_json()) + "\n\n";
        return sink.write(event.data(), event.size());
      });
}

void WebServer::Implementation::change_settings(const httplib::Request& request,
                                                httplib::Response& response) {
  const std::lock_guard lock(settings_mutex);
  const Settings settings =
      changed_settings({session.options(), session.live_options().budget_ms}, request.body);
  session.set_options(settings.options);
  session.set_budget_ms(settings.budget_ms);
  answer(response, describe_settings(session));
}

void WebServer::Implementation::change_memory(const httplib::Request& request,
                                              httplib::Response& response) {
  const Json json = Json::parse(request.body, nullptr, false);
  if (json != Json::object({{"forget", true}})) throw Error("memory: expected {\"forget\": true}");
  session.forget();
  answer(response, status_json()["memory"]);
}

void WebServer::Implementation::change_recording(const httplib::Request& request,
                                                 httplib::Response& response) {
  const Json json = Json::parse(request.body, nullptr, false);
  if (!json.is_object() || json.size() != 1 || !json.contains("active") ||
      !json["active"].is_boolean()) {
    throw Error(R"(recording: expected {"active": true} or {"active": false})");
  }
  if (json["active"].get<bool>()) {
    start_recording();
  } else {
    stop_recording();
  }
  answer(response, status_json()["recording"]);
}

void WebServer::Implementation::start_recording() {
  if (options.recordings.empty()) {
    throw Error("recording: start diminish with --recordings FOLDER to allow it");
  }
  const std::lock_guard lock(recording_mutex);
  if (recording && recording->status().active) throw Error("recording: already recording");
  const auto now = std::chrono::system_clock::now();
  const std::string time = fmt::format("{:%Y-%m-%dT%H-%M-%S}",
                                       fmt::localtime(std::chrono::system_clock::to_time_t(now)));
  std::filesystem::path folder = options.recordings / time;
  for (int i = 2; std::filesystem::exists(folder); ++i) {
    folder = options.recordings / fmt::format("{}-{}", time, i);
  }
  recording = std::make_shared<RecordingWriter>(folder, options.rig_file, session.rig(),
                                                options.scene_file, session.scene());
  recording_listener =
      session.on_frame([writer = recording](const auto& frame) { writer->offer(frame); });
}

void WebServer::Implementation::stop_recording() {
  const std::lock_guard lock(recording_mutex);
  recording_listener.reset();
  if (recording) recording->finish();
}

Json WebServer::Implementation::status_json() {
  Json json = to_json(session.status(), session.options());
  const std::lock_guard lock(recording_mutex);
  const RecordingStatus status = recording ? recording->status() : RecordingStatus{};
  json["recording"] = {{"allowed", !options.recordings.empty()},
                       {"active", status.active},
                       {"folder", status.folder},
                       {"frames", status.frames},
                       {"dropped", status.dropped},
                       {"problem", status.problem}};
  json["viewers"] = picture_viewers.load();
  return json;
}

WebServer::WebServer(LiveSession& session, const WebServerOptions& options)
    : implementation_(std::make_unique<Implementation>(session, options)) {}
WebServer::~WebServer() = default;

int WebServer::port() const {
  return implementation_->port;
}
std::string WebServer::url() const {
  const std::string& token = implementation_->options.token;
  return fmt::format("http://{}:{}/{}", implementation_->options.address, implementation_->port,
                     token.empty() ? "" : "?token=" + token);
}

}  // namespace diminish
