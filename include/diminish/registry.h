#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "diminish/error.h"

namespace diminish {

namespace detail {
/// Does nothing, in the library. A program that asks for nothing else there would be linked without
/// it, and so without what registers itself in it.
void need_library();
}  // namespace detail

/// Implementations found by name. Each registers itself in its own file:
///   const bool registered = Registry<Inpainter>::add("telea", [] { return ...; });
/// `Interface::kind` names what is registered ("inpainting method") in messages, and
/// `Interface::Factory` is the function that makes one.
template <class Interface>
class Registry {
 public:
  using Factory = typename Interface::Factory;

  static bool add(const std::string& name, Factory factory) {
    return entries().emplace(name, std::move(factory)).second;
  }
  static bool contains(const std::string& name) { return entries().count(name) != 0; }
  /// Throws Error that lists the known names.
  static const Factory& get(const std::string& name) {
    const auto found = entries().find(name);
    if (found == entries().end()) {
      throw Error("unknown " + std::string(Interface::kind) + " '" + name + "', expected one of " +
                  known());
    }
    return found->second;
  }
  static std::vector<std::string> names() {
    std::vector<std::string> result;
    for (const auto& [name, factory] : entries()) result.push_back(name);
    return result;
  }
  /// "a, b, c"
  static std::string known() {
    std::string list;
    for (const auto& [name, factory] : entries()) list += (list.empty() ? "" : ", ") + name;
    return list;
  }

 private:
  static std::map<std::string, Factory>& entries() {
    detail::need_library();
    static std::map<std::string, Factory> all;
    return all;
  }
};

}  // namespace diminish
