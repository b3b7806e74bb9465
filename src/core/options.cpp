#include "diminish/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <type_traits>

#include "core/text.h"
#include "diminish/error.h"
#include "diminish/registry.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {
namespace {

std::string allowed_range(const OptionInfo& info) {
  const std::string unit = info.unit[0] == '\0' ? "" : std::string(" ") + info.unit;
  if (info.max == std::numeric_limits<double>::max()) {
    return fmt::format("{} or more{}", info.min, unit);
  }
  return fmt::format("{} to {}{}", info.min, info.max, unit);
}

void check_method(const OptionInfo& option, const std::string& name) {
  const std::vector<std::string> known = method_names(option);
  if (known.empty() || std::find(known.begin(), known.end(), name) != known.end()) return;
  throw Error(fmt::format("{}: expected one of {}, got '{}'{}", option.name, join(known),
                          printable(name), left_out_note(option.kind, name)));
}

}  // namespace

void check(const Options& options) {
  for_each_option(options, [&](const OptionInfo& info, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
      // Written so that NaN is out of range.
      if (!(value >= info.min && value <= info.max)) {
        throw Error(fmt::format("{}: expected {}, got {}", info.name, allowed_range(info), value));
      }
    } else if constexpr (std::is_same_v<Value, std::string>) {
      check_method(info, value);
    }
  });
}

void check(const Options& options, const Rig& rig, const Scene& scene) {
  check(options);
  if (rig.rgbd.empty() && options.memory != "on") {
    throw Error(
        "memory: expected 'on', and a background (diminish scan) or planes: the rig has no RGB-D "
        "camera (rgbd: []), got '" +
        options.memory + "'");
  }
  std::vector<std::string> names;
  for (const OccluderSpec& occluder : scene.occluders) names.push_back(occluder.name);
  for (const std::string& kept : kept_objects(options)) {
    if (std::find(names.begin(), names.end(), kept) != names.end()) continue;
    throw Error(fmt::format("keep: the scene has no object '{}', expected one of {}",
                            printable(kept), join(names)));
  }
}

std::vector<std::string> method_names(const OptionInfo& option) {
  std::vector<std::string> names = option.choices;
  const std::vector<std::string> registered = registered_names(option.kind);
  names.insert(names.end(), registered.begin(), registered.end());
  return names;
}

std::vector<std::string> method_names(const std::string& option) {
  const Options options;
  std::vector<std::string> names;
  for_each_option(options, [&](const OptionInfo& info, const auto&) {
    if (option == info.name) names = method_names(info);
  });
  return names;
}

std::vector<std::string> kept_objects(const Options& options) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < options.keep.size();) {
    const std::size_t end = std::min(options.keep.find(',', begin), options.keep.size());
    const std::string_view word(options.keep.data() + begin, end - begin);
    const std::size_t first = word.find_first_not_of(' ');
    if (first != std::string_view::npos) {
      names.emplace_back(word.substr(first, word.find_last_not_of(' ') + 1 - first));
    }
    begin = end + 1;
  }
  return names;
}

}  // namespace diminish
