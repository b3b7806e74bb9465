#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "diminish/live.h"

namespace diminish {

/// What can be set while a session runs: a list of {name, kind, unit, help, value, min, max,
/// choices}, and the scene's objects.
nlohmann::ordered_json describe_settings(const LiveSession& session);

/// What a request asks for: `options` and `budget_ms` with changes.
struct Settings {
  Options options;
  double budget_ms = 0;
};

/// `current` with the changes of a JSON object, {"name": value, ...}. Throws Error that names what
/// is unknown or of the wrong type; ranges are checked where the settings are used.
Settings changed_settings(const Settings& current, const std::string& json);

}  // namespace diminish
