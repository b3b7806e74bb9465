#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diminish/error.h"
#include "diminish/export.h"

namespace diminish {

namespace detail {
// One table for the whole process, inside the library, so that everybody knows what a program or
// another shared object adds. Methods are stored by kind, so that listing them needs no knowledge
// of the stages.
DIMINISH_EXPORT bool add_method(std::string_view kind, const std::string& name,
                                std::shared_ptr<const void> factory);
/// Null if there is none.
DIMINISH_EXPORT const void* find_method(std::string_view kind, const std::string& name);
DIMINISH_EXPORT bool leave_out_method(std::string_view kind, const std::string& name,
                                      const std::string& needed);
/// What the method needs and this build lacks; empty if the build has the method.
DIMINISH_EXPORT std::string left_out_for(std::string_view kind, const std::string& name);
/// "unknown KIND 'NAME', expected one of A, B"
DIMINISH_EXPORT std::string unknown_method(std::string_view kind, const std::string& name);
}  // namespace detail

/// The names of all methods of a kind ("inpainting method"), in alphabetical order.
DIMINISH_EXPORT std::vector<std::string> registered_names(std::string_view kind);

/// ", which this build is without (it was built without libepoxy and EGL)"; empty for methods that
/// exist and for unknown ones.
DIMINISH_EXPORT std::string left_out_note(std::string_view kind, const std::string& name);

/// Implementations, found by name. Each registers itself in its own file, inside or outside the
/// library:
///   const bool registered = Registry<Inpainter>::add("telea", [] { return ...; });
/// `Interface::kind` names the kind of method ("inpainting method") and is unique to the interface.
/// `Interface::Factory` creates one. Threads may add and look up at the same time.
template <class Interface>
class Registry {
 public:
  using Factory = typename Interface::Factory;

  /// Whether the name was free.
  static bool add(const std::string& name, Factory factory) {
    return detail::add_method(Interface::kind, name,
                              std::make_shared<const Factory>(std::move(factory)));
  }
  /// Registers that this build lacks a method, and what it needs: "libepoxy and EGL".
  static bool leave_out(const std::string& name, const std::string& needed) {
    return detail::leave_out_method(Interface::kind, name, needed);
  }
  static bool contains(const std::string& name) {
    return detail::find_method(Interface::kind, name) != nullptr;
  }
  static bool is_left_out(const std::string& name) {
    return !detail::left_out_for(Interface::kind, name).empty();
  }
  /// Throws Error that lists the known names.
  static const Factory& get(const std::string& name) {
    const void* const factory = detail::find_method(Interface::kind, name);
    if (factory == nullptr) throw Error(unknown(name));
    return *static_cast<const Factory*>(factory);
  }
  static std::vector<std::string> names() { return registered_names(Interface::kind); }
  /// "a, b, c"
  static std::string known() {
    std::string list;
    for (const std::string& name : names()) list += (list.empty() ? "" : ", ") + name;
    return list;
  }
  /// "unknown inpainting method 'x', expected one of a, b, c"
  static std::string unknown(const std::string& name) {
    return detail::unknown_method(Interface::kind, name);
  }
};

}  // namespace diminish
