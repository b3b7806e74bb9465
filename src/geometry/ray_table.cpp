#include "geometry/ray_table.h"

#include "core/rows.h"
#include "geometry/shared_table.h"

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
  return shared_table<RayTable>(camera);
}

}  // namespace diminish
