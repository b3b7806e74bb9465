#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "diminish/intrinsics.h"

namespace diminish {

/// What is computed of a camera once, as Table(camera). There is one of each camera in the process,
/// for as long as somebody holds it; any thread may ask.
template <class Table>
std::shared_ptr<const Table> shared_table(const Intrinsics& camera) {
  static std::mutex mutex;
  static std::vector<std::pair<Intrinsics, std::weak_ptr<const Table>>> tables;
  const std::lock_guard lock(mutex);
  std::erase_if(tables, [](const auto& entry) { return entry.second.expired(); });
  for (const auto& [intrinsics, held] : tables) {
    auto table = held.lock();
    if (table && intrinsics == camera) return table;
  }
  auto table = std::make_shared<const Table>(camera);
  tables.emplace_back(camera, table);
  return table;
}

}  // namespace diminish
