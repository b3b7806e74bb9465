#pragma once

#include <string>

namespace diminish {

/// What to do about one of LiveStatus::problems, in plain words; empty if the problem says so
/// itself, or nothing is known.
std::string advice_for(const std::string& problem);

}  // namespace diminish
