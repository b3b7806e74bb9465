#include "serve/access.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <string_view>

namespace diminish {
namespace {

/// What stands behind an address: nothing, or a colon and up to five digits.
bool is_port_or_nothing(std::string_view text) {
  constexpr std::size_t most_characters = sizeof ":65535" - 1;
  if (text.empty()) return true;
  return text.size() > 1 && text.size() <= most_characters && text[0] == ':' &&
         text.find_first_not_of("0123456789", 1) == std::string_view::npos;
}

}  // namespace

bool is_loopback(const std::string& address) {
  constexpr unsigned char network = 127;
  if (address.find('\0') != std::string::npos) return false;  // where inet_pton would stop
  in_addr four{};
  if (inet_pton(AF_INET, address.c_str(), &four) == 1) {
    return reinterpret_cast<const unsigned char*>(&four)[0] == network;
  }
  in6_addr six{};
  if (inet_pton(AF_INET6, address.c_str(), &six) == 1) return IN6_IS_ADDR_LOOPBACK(&six);
  return address == "localhost";
}

std::string make_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

bool is_token(const std::string& text) {
  return text.find_first_not_of(
             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~") ==
         std::string::npos;
}

bool equals_secretly(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char other = b.empty() ? '\0' : b[i % b.size()];
    difference |= static_cast<unsigned>(a[i] ^ other);
  }
  return difference == 0;
}

bool names_loopback(const std::string& host_header) {
  // An IPv6 address stands in brackets, and nothing else does.
  const bool in_brackets = host_header.starts_with('[');
  const std::size_t end =
      in_brackets ? host_header.find(']') : std::min(host_header.find(':'), host_header.size());
  if (end == std::string::npos) return false;
  const std::size_t begin = in_brackets ? 1 : 0;
  const std::string host = host_header.substr(begin, end - begin);
  return is_loopback(host) && in_brackets == (host.find(':') != std::string::npos) &&
         is_port_or_nothing(std::string_view(host_header).substr(end + begin));
}

bool is_same_site(const std::string& origin_header, const std::string& host_header) {
  return origin_header.empty() || origin_header == "http://" + host_header ||
         origin_header == "https://" + host_header;
}

std::string cookie_of(const std::string& cookie_header, const std::string& name) {
  for (std::size_t begin = 0; begin < cookie_header.size();) {
    const std::size_t end = std::min(cookie_header.find(';', begin), cookie_header.size());
    const std::string_view pair(cookie_header.data() + begin, end - begin);
    const std::size_t first = std::min(pair.find_first_not_of(' '), pair.size());
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(first, equals - first) == name) {
      return std::string(pair.substr(equals + 1));
    }
    begin = end + 1;
  }
  return {};
}

}  // namespace diminish
