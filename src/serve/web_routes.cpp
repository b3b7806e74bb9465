#include "serve/web_routes.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <thread>

#include "diminish/error.h"
#include "page_files.h"
#include "serve/access.h"
#include "serve/http.h"
#include "serve/json_answers.h"
#include "serve/settings.h"
#include "serve/status_json.h"
#include "serve/webrtc_video.h"

namespace diminish {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;

constexpr milliseconds picture_wait{500};
constexpr milliseconds event_period{200};
constexpr std::size_t most_request_bytes = 1 << 16;

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

}  // namespace

WebRoutes::WebRoutes(LiveSession& session, const WebServerOptions& options)
    : session_(session), options_(options), encoder_(options.jpeg_quality) {
  if (!is_loopback(options.address) && options.token.empty()) {
    throw Error(options.address + ": an address that others can reach needs a token");
  }
  if (!is_token(options.token)) {
    throw Error("token: expected letters, digits, '-', '.', '_' and '~' only");
  }
}

WebRoutes::~WebRoutes() {
  stop_recording();
}

void WebRoutes::add_to(httplib::Server& server) {
  server.set_payload_max_length(most_request_bytes);
  server.set_default_headers(page_rules());
  server.set_pre_routing_handler([this](const auto& request, auto& response) {
    lower_priority_of_this_thread();
    return check_access(request, response) ? httplib::Server::HandlerResponse::Unhandled
                                           : httplib::Server::HandlerResponse::Handled;
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
  server.Get("/api/settings", [this](const auto&, auto& response) {
    answer(response, describe_settings(session_));
  });
  server.Post("/api/settings",
              [this](const auto& request, auto& response) { change_settings(request, response); });
  server.Post("/api/memory",
              [this](const auto& request, auto& response) { change_memory(request, response); });
  server.Post("/api/recording",
              [this](const auto& request, auto& response) { change_recording(request, response); });
  server.Post("/api/webrtc",
              [this](const auto& request, auto& response) { video(request, response); });
}

std::string WebRoutes::given_token(const httplib::Request& request) const {
  const std::string bearer = "Bearer ";
  const std::string header = request.get_header_value("Authorization");
  if (header.starts_with(bearer)) return header.substr(bearer.size());
  if (request.has_param("token")) return request.get_param_value("token");
  return cookie_of(request.get_header_value("Cookie"), cookie_name());
}

bool WebRoutes::check_access(const httplib::Request& request, httplib::Response& response) const {
  const std::string host = request.get_header_value("Host");
  if (!is_same_site(request.get_header_value("Origin"), host)) {
    refuse(response, 403, "Origin: expected this program's own page");
    return false;
  }
  if (options_.token.empty()) {
    if (!names_loopback(host)) {
      refuse(response, 403, "Host: expected this machine's own name, such as localhost");
      return false;
    }
  } else {
    const bool has_token = equals_secretly(given_token(request), options_.token);
    // The page's own files hold no secrets.
    if (request.path.starts_with("/api/") && !has_token) {
      refuse(response, 401, "expected the token that diminish printed when it started");
      return false;
    }
    // From the first visit on a cookie holds the token: no history and no log then does.
    if (request.path == "/" && request.has_param("token") && has_token) {
      response.set_header("Set-Cookie", fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/",
                                                    cookie_name(), options_.token));
      response.set_redirect("/", 303);
      return false;
    }
  }
  // A form on another site can send a request without asking, but not as JSON.
  if (request.method == "POST" &&
      !request.get_header_value("Content-Type").starts_with("application/json")) {
    refuse(response, 415, "Content-Type: expected application/json");
    return false;
  }
  return true;
}

std::shared_ptr<WebRoutes::Viewer> WebRoutes::admit(std::atomic<std::size_t>& viewers,
                                                    std::size_t most,
                                                    httplib::Response& response) const {
  auto viewer = std::make_shared<Viewer>(viewers, most);
  if (viewer->welcome()) return viewer;
  refuse(response, 503, fmt::format("already {} viewers", most));
  return nullptr;
}

void WebRoutes::stream(const httplib::Request& request, httplib::Response& response) {
  const View view = requested_view(request);
  const auto viewer = admit(picture_viewers_, options_.most_viewers, response);
  if (!viewer) return;
  response.set_header("Cache-Control", "no-store");
  response.set_chunked_content_provider(
      "multipart/x-mixed-replace; boundary=picture",
      [this, view, viewer, number = std::size_t{0}](std::size_t, httplib::DataSink& sink) mutable {
        if (stopped_) return false;
        const auto frame = session_.wait_for_frame(number, picture_wait);
        if (!frame) return sink.is_writable();
        number = frame->number;
        const PictureEncoder::Bytes jpeg = encoder_.jpeg(*frame, view);
        const std::string head = fmt::format(
            "--picture\r\nContent-Type: image/jpeg\r\nContent-Length: {}\r\nX-Frame: {}\r\n"
            "X-Stamp: {:.6f}\r\n\r\n",
            jpeg->size(), number, frame->input.stamp_s);
        return sink.write(head.data(), head.size()) &&
               sink.write(reinterpret_cast<const char*>(jpeg->data()), jpeg->size()) &&
               sink.write("\r\n", 2);
      });
}

void WebRoutes::picture(const httplib::Request& request, httplib::Response& response, bool is_png) {
  const View view = requested_view(request);
  const auto frame = session_.wait_for_frame(0, picture_wait);
  if (!frame) return refuse(response, 503, "there is no picture yet");
  response.set_header("Cache-Control", "no-store");
  response.set_header("X-Frame", std::to_string(frame->number));
  if (is_png) {
    const auto bytes = encoder_.png(*frame, view);
    response.set_content(reinterpret_cast<const char*>(bytes.data()), bytes.size(), "image/png");
  } else {
    const auto bytes = encoder_.jpeg(*frame, view);
    response.set_content(reinterpret_cast<const char*>(bytes->data()), bytes->size(), "image/jpeg");
  }
}

void WebRoutes::events(httplib::Response& response) {
  const auto viewer = admit(event_viewers_, options_.most_viewers, response);
  if (!viewer) return;
  response.set_header("Cache-Control", "no-store");
  response.set_chunked_content_provider(
      "text/event-stream", [this, viewer](std::size_t offset, httplib::DataSink& sink) {
        if (stopped_) return false;
        if (offset > 0) std::this_thread::sleep_for(event_period);
        const std::string event = "data: " + text_of(status_json()) + "\n\n";
        return sink.write(event.data(), event.size());
      });
}

void WebRoutes::change_settings(const httplib::Request& request, httplib::Response& response) {
  const std::lock_guard lock(settings_mutex_);
  const Settings settings =
      changed_settings({session_.options(), session_.live_options().budget_ms}, request.body);
  session_.set_options(settings.options);
  session_.set_budget_ms(settings.budget_ms);
  answer(response, describe_settings(session_));
}

void WebRoutes::change_memory(const httplib::Request& request, httplib::Response& response) {
  const Json json = Json::parse(request.body, nullptr, false);
  if (json != Json::object({{"forget", true}})) throw Error("memory: expected {\"forget\": true}");
  session_.forget();
  answer(response, status_json()["memory"]);
}

void WebRoutes::change_recording(const httplib::Request& request, httplib::Response& response) {
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

void WebRoutes::start_recording() {
  if (options_.recordings.empty()) {
    throw Error("recording: start diminish with --recordings FOLDER to allow it");
  }
  const std::lock_guard lock(recording_mutex_);
  if (recording_ && recording_->status().active) throw Error("recording: already recording");
  const auto now = std::chrono::system_clock::now();
  const std::string time = fmt::format("{:%Y-%m-%dT%H-%M-%S}",
                                       fmt::localtime(std::chrono::system_clock::to_time_t(now)));
  std::filesystem::path folder = options_.recordings / time;
  for (int i = 2; std::filesystem::exists(folder); ++i) {
    folder = options_.recordings / fmt::format("{}-{}", time, i);
  }
  recording_ = std::make_shared<RecordingWriter>(folder, options_.rig_file, session_.rig(),
                                                 options_.scene_file, session_.scene());
  recording_listener_ =
      session_.on_frame([writer = recording_](const auto& frame) { writer->offer(frame); });
}

void WebRoutes::stop_recording() {
  std::shared_ptr<RecordingWriter> ending;
  {
    const std::lock_guard lock(recording_mutex_);
    recording_listener_.reset();
    ending = recording_;
  }
  // Without the mutex: whoever asks for the status does not wait for the disk.
  if (ending) ending->finish();
}

Json WebRoutes::status_json() {
  Json json = to_json(session_.status(), session_.options());
  const std::lock_guard lock(recording_mutex_);
  const RecordingStatus status = recording_ ? recording_->status() : RecordingStatus{};
  json["recording"] = {{"allowed", !options_.recordings.empty()},
                       {"active", status.active},
                       {"folder", status.folder},
                       {"frames", status.frames},
                       {"dropped", status.dropped},
                       {"problem", status.problem}};
  json["viewers"] = picture_viewers_.load() + video_viewers_.load();
  const std::string why_no_video = why_no_webrtc();
  json["video"] = {{"available", why_no_video.empty()}, {"problem", why_no_video}};
  return json;
}

}  // namespace diminish
