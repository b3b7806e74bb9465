#include "diminish/web_server.h"

#include <fmt/format.h>

#include <thread>

#include "core/thread_name.h"
#include "diminish/error.h"
#include "serve/http.h"
#include "serve/web_routes.h"

namespace diminish {
namespace {

constexpr int write_timeout_s = 5;

}  // namespace

struct WebServer::Implementation {
  Implementation(LiveSession& session, const WebServerOptions& options_)
      : options(options_), routes(session, options_) {
    // One thread for each viewer's pictures, one for its events, and some for videos and short
    // requests.
    const std::size_t threads = 2 * options.most_viewers + 12;
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
    routes.add_to(server);
    if (options.port == 0) {
      port = server.bind_to_any_port(options.address);
    } else if (server.bind_to_port(options.address, options.port)) {
      port = options.port;
    }
    if (port <= 0) {
      throw Error(fmt::format("{}:{}: cannot listen; is another program using the port?",
                              options.address, options.port));
    }
    routes.listens_at(port);
    listener = std::thread([this] {
      name_this_thread("web");
      server.listen_after_bind();
    });
    while (!server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  ~Implementation() {
    routes.stop();
    server.stop();
    listener.join();
  }

  WebServerOptions options;
  WebRoutes routes;
  httplib::Server server;
  int port = 0;
  std::thread listener;
};

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
