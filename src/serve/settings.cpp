#include "serve/settings.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <set>
#include <type_traits>

#include "core/text.h"
#include "diminish/error.h"

namespace diminish {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* budget_name = "budget_ms";
constexpr double most_budget_ms = 10000;

template <class Value>
const char* kind_of() {
  if constexpr (std::is_same_v<Value, bool>) return "switch";
  if constexpr (std::is_same_v<Value, int>) return "integer";
  if constexpr (std::is_same_v<Value, double>) return "number";
  return "text";
}

[[noreturn]] void fail_type(const std::string& name, const char* expected, const Json& got) {
  throw Error(fmt::format("{}: expected {}, got {}", name, expected, printable(got.dump())));
}

void read(const std::string& name, const Json& json, bool& value) {
  if (!json.is_boolean()) fail_type(name, "true or false", json);
  value = json.get<bool>();
}
void read(const std::string& name, const Json& json, int& value) {
  const bool fits =
      json.is_number_integer() && std::abs(json.get<double>()) <= std::numeric_limits<int>::max();
  if (!fits) fail_type(name, "a whole number", json);
  value = json.get<int>();
}
void read(const std::string& name, const Json& json, double& value) {
  if (!json.is_number()) fail_type(name, "a number", json);
  value = json.get<double>();
}
void read(const std::string& name, const Json& json, std::string& value) {
  if (!json.is_string()) fail_type(name, "a text", json);
  value = json.get<std::string>();
}

}  // namespace

Json describe_settings(const LiveSession& session) {
  Json list = Json::array();
  const Options options = session.options();
  for_each_option(options, [&](const OptionInfo& info, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    Json setting = {{"name", info.name},
                    {"kind", kind_of<Value>()},
                    {"unit", info.unit},
                    {"help", info.help},
                    {"value", value}};
    if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
      setting["min"] = info.min;
      if (info.max < std::numeric_limits<double>::max()) setting["max"] = info.max;
    }
    const std::vector<std::string> methods = method_names(info);
    if (!methods.empty()) setting["choices"] = methods;
    list.push_back(std::move(setting));
  });
  list.push_back({{"name", budget_name},
                  {"kind", "number"},
                  {"unit", "milliseconds"},
                  {"help", "Time budget of a frame, above which quality steps down; 0: none"},
                  {"value", session.live_options().budget_ms},
                  {"min", 0},
                  {"max", most_budget_ms}});
  Json objects = Json::array();
  for (const OccluderSpec& occluder : session.scene().occluders) objects.push_back(occluder.name);
  return {{"settings", list}, {"objects", objects}};
}

Settings changed_settings(const Settings& current, const std::string& json) {
  const Json changes = Json::parse(json, nullptr, false);
  if (!changes.is_object()) {
    throw Error("settings: expected a JSON object such as {\"mode\": \"half\"}");
  }
  Settings changed = current;
  std::set<std::string> known;
  for_each_option(changed.options, [&](const OptionInfo& info, auto& value) {
    known.insert(info.name);
    if (changes.contains(info.name)) read(info.name, changes[info.name], value);
  });
  for (const auto& [name, value] : changes.items()) {
    if (name == budget_name) {
      read(name, value, changed.budget_ms);
      if (!(changed.budget_ms >= 0 && changed.budget_ms <= most_budget_ms)) {
        throw Error(fmt::format("{}: expected 0 to {} milliseconds, got {}", name, most_budget_ms,
                                changed.budget_ms));
      }
    } else if (known.count(name) == 0) {
      throw Error(fmt::format("settings: unknown setting '{}'", printable(name)));
    }
  }
  return changed;
}

}  // namespace diminish
