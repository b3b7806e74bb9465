#include "serve/web_routes.h"

#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "diminish/frame_source.h"
#include "diminish/live.h"
#include "fuzzed_folder.h"
#include "serve/http.h"

namespace {

using namespace diminish;

const std::string token = "fuzzed-token";

/// A connection: the request is there, the answer is kept, and a viewer hangs up soon.
class Connection : public httplib::Stream {
 public:
  explicit Connection(std::string_view request) : request_(request) {}
  std::string answer;

  bool is_readable() const override { return true; }
  bool is_writable() const override { return answer.size() < most_bytes; }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t count = request_.copy(to, size);
    request_.remove_prefix(count);
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* from, std::size_t size) override {
    if (!is_writable()) return -1;
    answer.append(from, size);
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { local(ip, port); }
  void get_local_ip_and_port(std::string& ip, int& port) const override { local(ip, port); }
  socket_t socket() const override { return -1; }

 private:
  static constexpr std::size_t most_bytes = 300;
  static void local(std::string& ip, int& port) {
    ip = "127.0.0.1";
    port = 8080;
  }
  std::string_view request_;
};

/// A server without sockets.
class Server : public httplib::Server {
 public:
  Server(LiveSession& session, const WebServerOptions& options) : routes_(session, options) {
    routes_.listens_at(8080);
    routes_.add_to(*this);
  }
  std::string answer(std::string_view request) {
    Connection connection(request);
    bool is_closed = false;
    process_request(connection, true, is_closed, nullptr);
    return connection.answer;
  }

 private:
  WebRoutes routes_;
};

/// Of one colour.
std::string picture(const std::string& pixel) {
  constexpr int pixels = 16 * 12;
  std::string text = "P6 16 12 255\n";
  for (int i = 0; i < pixels; ++i) text += pixel;
  return text;
}

/// Three pictures and no more, so that nothing else runs than what is asked.
LiveSession& session() {
  static FuzzedFolder folder;
  static const Recording recording = [] {
    const std::string camera =
        "{width: 16, height: 12, camera_matrix: [16, 16, 8, 6], distortion: [0, 0, 0, 0, 0]}";
    folder.fill("== rig.yaml\ncolor: " + camera +
                "\nrgbd: []\npose: {source: fixed, color_from_rgbd: {}}\n"
                "== scene.yaml\noccluders: [{name: thing, detector: mask, color: masks}]\n"
                "== color.txt\n1 a.ppm\n1.1 b.ppm\n"
                "== a.ppm\n" +
                picture("abz") + "\n== b.ppm\n" + picture("zba") + "\n== masks/a.png\n" +
                picture(std::string(3, '\0')));
    return load_recording(folder.path());
  }();
  static LiveSession live(recording.rig, recording.scene, {},
                          {{"color", "recording:" + folder.path().string()}}, {});
  static const bool has_pictures = live.wait_for_frame(0, std::chrono::seconds(60)) != nullptr;
  if (!has_pictures) std::abort();
  return live;
}

/// As browsers write what may not stand in an address.
std::string without_percents(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_coded = text[i] == '%' && i + 2 < text.size() &&
                          std::isxdigit(static_cast<unsigned char>(text[i + 1])) != 0 &&
                          std::isxdigit(static_cast<unsigned char>(text[i + 2])) != 0;
    if (!is_coded) {
      plain += text[i];
      continue;
    }
    plain += static_cast<char>(std::stoi(std::string(text.substr(i + 1, 2)), nullptr, 16));
    i += 2;
  }
  return plain;
}

}  // namespace

/// Any request gets an answer, and what the camera sees only if it has the token, or names this
/// machine.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Server open(session(), {});
  static Server guarded(session(), {.token = token});
  if (size == 0) return 0;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const bool is_guarded = input[0] == 'T';
  const std::string answer = (is_guarded ? guarded : open).answer(input.substr(1));
  if (answer.empty()) return 0;  // the connection ended before the request did
  if (!answer.starts_with("HTTP/1.1 ")) std::abort();
  const bool succeeds = answer.starts_with("HTTP/1.1 200");
  const bool is_page = answer.find("Content-Type: text/html") != std::string::npos ||
                       answer.find("Content-Type: text/css") != std::string::npos ||
                       answer.find("Content-Type: text/javascript") != std::string::npos;
  const std::string plain = without_percents(input);
  const auto has = [&](const char* text) { return plain.find(text) != std::string::npos; };
  if (succeeds && is_guarded && !is_page && !has(token.c_str())) std::abort();
  if (succeeds && !is_guarded && !has("localhost") && !has("127.") && !has(":1")) std::abort();
  return 0;
}
