#include "diminish/options.h"

#include <fmt/format.h>

#include <type_traits>

#include "core/text.h"
#include "diminish/color_corrector.h"
#include "diminish/error.h"
#include "diminish/inpainter.h"
#include "diminish/reconstructor.h"
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

template <class Interface>
void check_registered(const char* option, const std::string& name) {
  if (Registry<Interface>::contains(name)) return;
  throw Error(fmt::format("{}: expected one of {}, got '{}'", option, Registry<Interface>::known(),
                          printable(name)));
}

void check_backend(const std::string& name) {
  if (name == "auto" || Registry<Reconstructor>::contains(name)) return;
  if (name == "gl" || name == "gl_geometry") {
    throw Error(
        fmt::format("backend: expected one of auto, {}, got '{}', which this build is "
                    "without (it was built without libepoxy and EGL)",
                    Registry<Reconstructor>::known(), name));
  }
  throw Error(fmt::format("backend: expected one of auto, {}, got '{}'",
                          Registry<Reconstructor>::known(), printable(name)));
}

}  // namespace

void check(const Options& options) {
  for_each_option(options, [](const OptionInfo& info, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, double>) {
      // Written so that NaN is out of range.
      if (!(value >= info.min && value <= info.max)) {
        throw Error(fmt::format("{}: expected {}, got {}", info.name, allowed_range(info), value));
      }
    }
  });
  check_registered<ColorCorrector>("color_correct", options.color_correct);
  check_registered<Inpainter>("inpaint", options.inpaint);
  check_registered<ViewMode>("mode", options.mode);
  check_backend(options.backend);
}

}  // namespace diminish
