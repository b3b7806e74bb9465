#include "option_flags.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <type_traits>

namespace diminish {
namespace {

std::string flag_name(const OptionInfo& info) {
  std::string name = info.name;
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

}  // namespace

void add_option_flags(CLI::App& command, Options& options) {
  for_each_option(options, [&](const OptionInfo& info, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, bool>) {
      const std::string off = value ? ",!--no-" + flag_name(info).substr(2) : "";
      command.add_flag(flag_name(info) + off, value, info.help)->group("Options of the pipeline");
    } else {
      auto* flag = command.add_option(flag_name(info), value, info.help)
                       ->capture_default_str()
                       ->group("Options of the pipeline");
      if constexpr (std::is_same_v<Value, std::string>) {
        const std::vector<std::string> methods = method_names(info);
        flag->type_name(methods.empty() ? info.unit
                                        : fmt::format("{{{}}}", fmt::join(methods, ",")));
      } else {
        flag->type_name(info.unit);
      }
    }
  });
}

}  // namespace diminish
