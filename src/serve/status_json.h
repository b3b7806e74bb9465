#pragma once

#include <nlohmann/json.hpp>

#include "diminish/live.h"

namespace diminish {

/// A session's status as docs/http-api.md describes it.
nlohmann::ordered_json to_json(const LiveStatus& status, const Options& options);

}  // namespace diminish
