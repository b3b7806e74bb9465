#include "diminish/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <type_traits>

#include "core/text.h"
#include "diminish/color_corrector.h"
#include "diminish/error.h"
#include "diminish/inpainter.h"
#include "diminish/reconstructor.h"
#include "diminish/scene.h"
#include "diminish/view_mode.h"

namespace diminish {
namespace {

std::string allowed_range(const OptionInfo& info) {
  const std::string unit = info.unit[0] == '\0' ? "" : std::string(" ") + info.unit;
  if (info.max == std::numeric_limits<double>::max()) {
    return fmt::format("{} or more{}", info.min, unit);
  }
  return fmt::format("{} to {}{}", info.min, info.max, unit);
}

void check_method(const char* option, const std::string& name) {
  const std::vector<std::string> known = method_names(option);
  if (known.empty() || std::find(known.begin(), known.end(), name) != known.end()) return;
  throw Error(
      fmt::format("{}: expected one of {}, got '{}'", option, join(known), printable(name)));
}

void check_backend(const std::string& name) {
  const std::vector<std::string> known = method_names("backend");
  const bool is_left_out = name == "gl" || name == "gl_geometry";
  if (is_left_out && std::find(known.begin(), known.end(), name) == known.end()) {
    throw Error(
        fmt::format("backend: expected one of {}, got '{}', which this build is without (it was "
                    "built without libepoxy and EGL)",
                    join(known), name));
  }
  check_method("backend", name);
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
      if (&value == &options.backend) {
        check_backend(value);
      } else {
        check_method(info.name, value);
      }
    }
  });
}

void check(const Options& options, const Scene& scene) {
  check(options);
  std::vector<std::string> names;
  for (const OccluderSpec& occluder : scene.occluders) names.push_back(occluder.name);
  for (const std::string& kept : kept_objects(options)) {
    if (std::find(names.begin(), names.end(), kept) != names.end()) continue;
    throw Error(fmt::format("keep: the scene has no object '{}', expected one of {}",
                            printable(kept), join(names)));
  }
}

std::vector<std::string> method_names(const std::string& option) {
  if (option == "color_correct") return Registry<ColorCorrector>::names();
  if (option == "inpaint") return Registry<Inpainter>::names();
  if (option == "mode") return Registry<ViewMode>::names();
  if (option == "merge_cameras") return {"blend", "choose"};
  if (option == "backend") {
    std::vector<std::string> names = Registry<Reconstructor>::names();
    names.insert(names.begin(), "auto");
    return names;
  }
  return {};
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
