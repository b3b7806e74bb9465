#include "diminish/registry.h"

#include <functional>
#include <map>
#include <mutex>

#include "core/text.h"

namespace diminish {
namespace {

struct Kind {
  std::map<std::string, std::shared_ptr<const void>> methods;
  std::map<std::string, std::string> left_out;  ///< what each needs
};

struct Table {
  std::mutex mutex;
  std::map<std::string, Kind, std::less<>> kinds;

  Kind& of(std::string_view kind) {
    const auto found = kinds.find(kind);
    return found != kinds.end() ? found->second : kinds[std::string(kind)];
  }
};

/// Made by whoever comes first: files register themselves before main, in any order.
Table& table() {
  static Table all;
  return all;
}

}  // namespace

namespace detail {

bool add_method(std::string_view kind, const std::string& name,
                std::shared_ptr<const void> factory) {
  const std::lock_guard lock(table().mutex);
  return table().of(kind).methods.emplace(name, std::move(factory)).second;
}

const void* find_method(std::string_view kind, const std::string& name) {
  const std::lock_guard lock(table().mutex);
  const auto& methods = table().of(kind).methods;
  const auto found = methods.find(name);
  return found == methods.end() ? nullptr : found->second.get();
}

bool leave_out_method(std::string_view kind, const std::string& name, const std::string& needed) {
  const std::lock_guard lock(table().mutex);
  return table().of(kind).left_out.emplace(name, needed).second;
}

std::string left_out_for(std::string_view kind, const std::string& name) {
  if (find_method(kind, name) != nullptr) return "";
  const std::lock_guard lock(table().mutex);
  const auto& left_out = table().of(kind).left_out;
  const auto found = left_out.find(name);
  return found == left_out.end() ? "" : found->second;
}

std::string unknown_method(std::string_view kind, const std::string& name) {
  return "unknown " + std::string(kind) + " '" + printable(name) + "'" + left_out_note(kind, name) +
         ", expected one of " + join(registered_names(kind));
}

}  // namespace detail

std::vector<std::string> registered_names(std::string_view kind) {
  const std::lock_guard lock(table().mutex);
  std::vector<std::string> names;
  for (const auto& [name, factory] : table().of(kind).methods) names.push_back(name);
  return names;
}

std::string left_out_note(std::string_view kind, const std::string& name) {
  const std::string needed = detail::left_out_for(kind, name);
  return needed.empty() ? ""
                        : ", which this build is without (it was built without " + needed + ")";
}

}  // namespace diminish
