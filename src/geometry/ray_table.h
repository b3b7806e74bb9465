#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "diminish/intrinsics.h"

namespace diminish {

/// The rays (x, y, 1) of all of a camera's pixels, with one array for each coordinate.
class RayTable {
 public:
  /// Rows are padded with zeros to multiples of this.
  static constexpr int block = 16;

  explicit RayTable(const Intrinsics& camera);

  /// The camera's table. There is one of each camera in the process, for as long as somebody holds
  /// it; any thread may ask. Cost, when it has to be made: 0.1 us a pixel, shared by threads.
  static std::shared_ptr<const RayTable> of(const Intrinsics& camera);

  int width() const { return width_; }
  int height() const { return height_; }

  Eigen::Vector2f operator()(int column, int row) const { return {x(row)[column], y(row)[column]}; }
  const float* x(int row) const { return x_.data() + at(row); }
  const float* y(int row) const { return y_.data() + at(row); }

 private:
  std::size_t at(int row) const { return static_cast<std::size_t>(row) * pitch_; }

  int width_, height_;
  std::size_t pitch_;
  std::vector<float> x_, y_;
};

}  // namespace diminish
