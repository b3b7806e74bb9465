#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"

namespace diminish {

double CameraUri::number(const std::string& key, double fallback, double min, double max) const {
  const auto found = parameters.find(key);
  if (found == parameters.end()) return fallback;
  const auto value = parse_number(found->second);
  if (!value || *value < min || *value > max) {
    fail(fmt::format("{}: expected a number from {} to {}, got '{}'", key, min, max,
                     printable(found->second)));
  }
  return *value;
}

std::string CameraUri::text_of(const std::string& key, const std::string& fallback) const {
  const auto found = parameters.find(key);
  return found == parameters.end() ? fallback : found->second;
}

void CameraUri::expect_parameters(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : parameters) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    fail(fmt::format("unknown parameter '{}', expected {}", printable(key),
                     known.empty() ? "none" : "one of " + join(known)));
  }
}

void CameraUri::fail(const std::string& message, Error::Category category) const {
  throw Error(category, printable(text) + ": " + message);
}

CameraUri parse_camera_uri(const std::string& text) {
  CameraUri uri;
  uri.text = text;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0) {
    uri.fail("expected a camera such as v4l2:/dev/video0, of one of " +
             Registry<CameraSource>::known());
  }
  uri.scheme = text.substr(0, colon);
  uri.target = text.substr(colon + 1);
  using Sources = Registry<CameraSource>;
  // What this build is without may be a text of its own, too; to open it fails in any case.
  if (Sources::is_left_out(uri.scheme)) return uri;
  if (Sources::contains(uri.scheme) && Sources::get(uri.scheme).free_text) return uri;
  const std::size_t question = uri.target.find('?');
  if (question == std::string::npos) return uri;
  std::string rest = uri.target.substr(question + 1);
  uri.target.resize(question);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string parameter = rest.substr(0, end);
    rest.erase(0, end + 1);
    const std::size_t equals = parameter.find('=');
    const std::string key = parameter.substr(0, equals);
    if (key.empty()) uri.fail("expected key=value after '?', got '" + printable(parameter) + "'");
    uri.parameters[key] = equals == std::string::npos ? "" : parameter.substr(equals + 1);
  }
  return uri;
}

}  // namespace diminish
