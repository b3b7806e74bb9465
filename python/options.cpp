#include "diminish/options.h"

#include <pybind11/stl.h>

#include <string>
#include <type_traits>

#include "bindings.h"

namespace diminish::python {
namespace {

/// Calls visit(value) for the option of this name.
template <class AnyOptions, class Visit>
void with_option(AnyOptions& options, const std::string& name, const Visit& visit) {
  for_each_option(options, [&](const OptionInfo& info, auto& value) {
    if (name == info.name) visit(value);
  });
}

}  // namespace

void add_options(py::module_& module) {
  py::class_<Options> options(module, "Options",
                              "Everything that can be chosen: Options(memory='off', ...).");
  options.def(py::init([](const py::kwargs& values) {
    auto made = std::make_unique<Options>();
    const py::object self = py::cast(made.get(), py::return_value_policy::reference);
    for (const auto& [name, value] : values) py::setattr(self, name, value);
    check(*made);
    return made;
  }));
  const Options defaults;
  for_each_option(defaults, [&](const OptionInfo& info, const auto& fallback) {
    using Value = std::decay_t<decltype(fallback)>;
    const std::string name = info.name;
    const std::string unit = info.unit;
    const std::string help = std::string(info.help) + (unit.empty() ? "" : " (" + unit + ")");
    options.def_property(
        info.name,
        [name](const Options& self) {
          Value result{};
          with_option(self, name, [&](const auto& value) {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Value>) result = value;
          });
          return result;
        },
        [name](Options& self, const Value& wanted) {
          with_option(self, name, [&](auto& value) {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Value>) value = wanted;
          });
        },
        help.c_str());
  });
  module.def(
      "methods", [](const std::string& option) { return method_names(option); }, py::arg("option"),
      "The methods that an option names, such as 'inpaint'.");
}

}  // namespace diminish::python
