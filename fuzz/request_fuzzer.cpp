#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "serve/access.h"

namespace {

/// Written another way than what it judges: no name that could be somebody else's.
bool may_name_loopback(const std::string& host) {
  if (host.find_first_of("lL") == 0) return host.size() < sizeof "localhost:65535";
  return host.find_first_not_of("0123456789abcdefABCDEF.:[]") == std::string::npos;
}

}  // namespace

/// A request's headers, a line each: Host, Origin, Cookie. None names this machine by accident.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream lines(std::string(reinterpret_cast<const char*>(data), size));
  std::string host;
  std::string origin;
  std::string cookie;
  std::getline(lines, host);
  std::getline(lines, origin);
  std::getline(lines, cookie);
  if (diminish::names_loopback(host) && !may_name_loopback(host)) std::abort();
  if (diminish::is_same_site(origin, host) && !origin.empty() &&
      origin.find(host) == std::string::npos) {
    std::abort();
  }
  const std::string token = diminish::cookie_of(cookie, "token");
  if (!token.empty() && cookie.find(token) == std::string::npos) std::abort();
  if (diminish::is_token(token) && token.find_first_of(" ;\r\n\"") != std::string::npos) {
    std::abort();
  }
  return 0;
}
