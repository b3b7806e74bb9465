#pragma once

#include <map>
#include <memory>
#include <string>

#include "diminish/registry.h"

namespace diminish {

/// The registered methods of one kind that have been used. Each is created once and keeps its
/// memory from frame to frame.
template <class Interface>
class Methods {
 public:
  /// Throws Error for an unknown name.
  Interface& get(const std::string& name) {
    auto& found = made_[name];
    if (!found) found = Registry<Interface>::get(name)();
    return *found;
  }

 private:
  std::map<std::string, std::unique_ptr<Interface>> made_;
};

}  // namespace diminish
