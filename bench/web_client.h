#pragma once

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <string>

namespace diminish {

/// A connection to a web server of this machine.
class WebClient {
 public:
  WebClient(int port, const std::string& request) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval patience = {2, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_open_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
               send(socket_, request.data(), request.size(), MSG_NOSIGNAL) > 0;
  }
  ~WebClient() { close(socket_); }
  WebClient(const WebClient&) = delete;
  WebClient& operator=(const WebClient&) = delete;

  /// At most 16 kB of what has come; empty if nothing has, or at the end.
  std::string read(int flags = 0) {
    std::array<char, 16384> buffer;  // NOLINT: recv fills it
    const auto count = is_open_ ? recv(socket_, buffer.data(), buffer.size(), flags) : 0;
    if (count == 0 || (count < 0 && errno != EAGAIN)) is_open_ = false;
    return {buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }
  bool is_open() const { return is_open_; }

 private:
  int socket_;
  bool is_open_ = false;
};

inline std::string get_request(const std::string& path) {
  return "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";
}

inline std::string post_request(const std::string& path, const std::string& body) {
  return fmt::format(
      "POST {} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
      "Content-Length: {}\r\nConnection: close\r\n\r\n{}",
      path, body.size(), body);
}

}  // namespace diminish
