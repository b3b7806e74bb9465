#include "geometry/ray_table.h"

#include <oneapi/tbb/task_arena.h>

#include <mutex>
#include <utility>

#include "core/rows.h"

namespace diminish {

RayTable::RayTable(const Intrinsics& camera)
    : width_(camera.width),
      height_(camera.height),
      pitch_(static_cast<std::size_t>((width_ + block - 1) / block * block)),
      x_(at(height_)),
      y_(at(height_)) {
  const Lens lens(camera);
  for_rows(height_, [&](Rows rows) {
    for (int row = rows.first; row < rows.last; ++row) {
      for (int column = 0; column < width_; ++column) {
        const Eigen::Vector2f ray = lens.undistort({column, row}).cast<float>();
        const std::size_t pixel = at(row) + static_cast<std::size_t>(column);
        x_[pixel] = ray.x();
        y_[pixel] = ray.y();
      }
    }
  });
}

std::shared_ptr<const RayTable> RayTable::of(const Intrinsics& camera) {
  static std::mutex mutex;
  static std::vector<std::pair<Intrinsics, std::weak_ptr<const RayTable>>> tables;
  const std::lock_guard lock(mutex);
  std::erase_if(tables, [](const auto& entry) { return entry.second.expired(); });
  for (const auto& [intrinsics, held] : tables) {
    auto table = held.lock();
    if (table && intrinsics == camera) return table;
  }
  std::shared_ptr<const RayTable> table;
  // While this thread waits for the others, it must not begin what would ask for a table, too.
  oneapi::tbb::this_task_arena::isolate([&] { table = std::make_shared<const RayTable>(camera); });
  tables.emplace_back(camera, table);
  return table;
}

}  // namespace diminish
