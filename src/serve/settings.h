#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "diminish/live.h"

namespace diminish {

/// The settings of a running session: a list of {name, kind, unit, help, value, min, max, choices},
/// and the scene's objects.
nlohmann::ordered_json describe_settings(const LiveSession& session);

/// A request's `options` and `budget_ms`, with its changes.
struct Settings {
  Options options;
  double budget_ms = 0;
};

/// Applies a JSON object {"name": value, ...} to `current`. Throws Error that names an unknown
/// setting or a wrong type. Ranges are checked where the settings are used.
Settings changed_settings(const Settings& current, const std::string& json);

}  // namespace diminish
