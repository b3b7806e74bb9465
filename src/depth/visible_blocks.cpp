#include "depth/visible_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/visible_blocks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The nearest and the farthest depth of each column of some rows; 65535 and 0 where there is none.
void FindDepths(const std::uint16_t* first, std::ptrdiff_t pitch, int rows, int columns,
                std::uint16_t* nearest, std::uint16_t* farthest) {
  const auto find = [&](auto d, int x) HWY_ATTR {
    const auto one = hn::Set(d, std::uint16_t{1});
    auto least = hn::Set(d, std::uint16_t{65535});
    auto greatest = hn::Zero(d);
    for (int y = 0; y < rows; ++y) {
      const auto depth = hn::LoadU(d, first + y * pitch + x);
      // 0 becomes the greatest.
      least = hn::Min(least, hn::Sub(depth, one));
      greatest = hn::Max(greatest, depth);
    }
    hn::StoreU(hn::SaturatedAdd(least, one), d, nearest + x);
    hn::StoreU(greatest, d, farthest + x);
  };
  const hn::ScalableTag<std::uint16_t> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= columns; x += lanes) find(d, x);
  for (; x < columns; ++x) find(hn::CappedTag<std::uint16_t, 1>(), x);
}

}  // namespace
}  // namespace diminish::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace diminish {
namespace {

HWY_EXPORT(FindDepths);

/// Covers the rounding of vertices, and the lens between the points that are undistorted.
constexpr int margin_px = 4;
constexpr int points_of_side = 16;

/// The pixels of a block and those next to it.
Rect with_neighbours(int column, int row, const Rect& image) {
  return intersect(grow({column * VisibleBlocks::width, row * VisibleBlocks::height,
                         VisibleBlocks::width, VisibleBlocks::height},
                        1),
                   image);
}

}  // namespace

VisibleBlocks::VisibleBlocks(const RgbdCamera& camera, const Intrinsics& color)
    : color_(color),
      unit_m_(static_cast<float>(camera.depth_unit_m)),
      image_width_(camera.depth.width),
      image_height_(camera.depth.height) {
  visible_.resize((image_width_ + width - 1) / width, (image_height_ + height - 1) / height);
  const Lens lens(camera.depth);
  for (int row = 0; row < visible_.rows(); ++row) {
    for (int column = 0; column < visible_.columns(); ++column) {
      // A block is small: its other rays lie beyond these by less than the margin.
      const Rect pixels = with_neighbours(column, row, camera.depth.bounds());
      Eigen::Array2d least = lens.undistort({pixels.x, pixels.y});
      Eigen::Array2d greatest = least;
      for (const int y : {pixels.y, pixels.y + pixels.height / 2, pixels.bottom() - 1}) {
        for (const int x : {pixels.x, pixels.x + pixels.width / 2, pixels.right() - 1}) {
          const Eigen::Array2d ray = lens.undistort({x, y});
          least = least.min(ray);
          greatest = greatest.max(ray);
        }
      }
      const auto range = [&](int axis) {
        return Range{static_cast<float>(least[axis]), static_cast<float>(greatest[axis])};
      };
      rays_.push_back({range(0), range(1)});
    }
  }
  depth_m_.resize(rays_.size());
}

void VisibleBlocks::find(ImageView<std::uint16_t> depth, const RigidTransform& color_from_depth,
                         const Rect& region) {
  color_from_depth_ = color_from_depth;
  sides_ = {};
  for (const int axis : {0, 1}) add_sides(region, axis, sides_);
  const auto pitch = depth.stride() / std::ptrdiff_t{sizeof(std::uint16_t)};
  for_rows(image_height_, [&](Rows rows) {
    Depths& depths = depths_[rows.band];
    depths.nearest.resize(static_cast<std::size_t>(image_width_));
    depths.farthest.resize(depths.nearest.size());
    for (int row = rows.first / height; row * height < rows.last; ++row) {
      const Rect band = with_neighbours(0, row, depth.bounds());
      HWY_DYNAMIC_DISPATCH(FindDepths)
      (depth.row(band.y), pitch, band.height, depth.width(), depths.nearest.data(),
       depths.farthest.data());
      for (int column = 0; column < visible_.columns(); ++column) {
        const Rect pixels = with_neighbours(column, row, depth.bounds());
        const auto first = static_cast<std::size_t>(pixels.x);
        const auto last = static_cast<std::size_t>(pixels.right());
        std::uint16_t nearest = 65535;
        std::uint16_t farthest = 0;
        for (std::size_t x = first; x < last; ++x) {
          nearest = std::min(nearest, depths.nearest[x]);
          farthest = std::max(farthest, depths.farthest[x]);
        }
        Range& depth_m = depth_m_[visible_.index(column, row)];
        depth_m = {static_cast<float>(nearest) * unit_m_, static_cast<float>(farthest) * unit_m_};
        visible_(column, row) =
            farthest > 0 && is_inside(sides_, rays_[visible_.index(column, row)], depth_m) ? 1 : 0;
      }
    }
  });
  find_part();
}

void VisibleBlocks::clear() {
  visible_.clear();
  find_part();
}

void VisibleBlocks::add_sides(const Rect& rectangle, int axis, Sides& sides) const {
  const Rect wide = grow(rectangle, margin_px);
  const Eigen::Array2d first(wide.x, wide.y);
  const Eigen::Array2d size(wide.width, wide.height);
  for (const int sign : {-1, 1}) {
    // The coordinate of the ray that is furthest out along this side.
    double furthest = -std::numeric_limits<double>::infinity();
    for (int i = 0; i <= points_of_side; ++i) {
      Eigen::Array2d along;
      along[axis] = sign < 0 ? 0 : 1;
      along[1 - axis] = static_cast<double>(i) / points_of_side;
      const Eigen::Vector2d pixel = first + along * size;
      const Eigen::Vector2d ray = color_.undistort(pixel);
      const auto back = color_.distort(ray);
      const bool has_ray = back && (*back - pixel).norm() < 0.1;
      furthest =
          std::max(furthest, has_ray ? sign * ray[axis] : std::numeric_limits<double>::infinity());
    }
    if (!std::isfinite(furthest)) continue;
    // Beyond it sign * x > furthest * z, in the colour camera's frame.
    Eigen::Vector3d normal(0, 0, -furthest);
    normal[axis] = sign;
    const Eigen::Vector3f in_depth =
        (color_from_depth_.rotation.transpose() * normal).cast<float>();
    sides.planes[sides.count++] = {in_depth.x(), in_depth.y(), in_depth.z(),
                                   static_cast<float>(normal.dot(color_from_depth_.translation))};
  }
}

bool VisibleBlocks::is_inside(const Sides& sides, const Rays& rays, const Range& depth_m) {
  for (std::size_t i = 0; i < sides.count; ++i) {
    const Plane& side = sides.planes[i];
    // The point of the body that lies least far beyond the plane.
    const float slope = side.x * (side.x > 0 ? rays.x.least : rays.x.greatest) +
                        side.y * (side.y > 0 ? rays.y.least : rays.y.greatest) + side.z;
    if (slope * (slope > 0 ? depth_m.least : depth_m.greatest) + side.offset > 0) return false;
  }
  return true;
}

void VisibleBlocks::find_part() {
  const auto columns_of = [&](int row) {
    DepthPart::Columns columns{visible_.columns(), 0};
    if (row < 0 || row >= visible_.rows()) return columns;
    for (int column = 0; column < visible_.columns(); ++column) {
      if (visible_(column, row) == 0) continue;
      columns.first = std::min(columns.first, column - 1);
      columns.last = column + 2;
    }
    return columns;
  };
  part_.begin(height);
  bounds_ = {};
  for (int row = 0; row < visible_.rows(); ++row) {
    DepthPart::Columns columns = columns_of(row);
    if (columns.count() > 0) {
      bounds_ = join(bounds_, {columns.first + 1, row, columns.count() - 2, 1});
    }
    for (const int beside : {row - 1, row + 1}) {
      columns.first = std::min(columns.first, columns_of(beside).first);
      columns.last = std::max(columns.last, columns_of(beside).last);
    }
    DepthPart::Columns pixels;
    if (columns.count() > 0) {
      pixels = {std::max(0, columns.first * width), std::min(image_width_, columns.last * width)};
    }
    part_.add_band(pixels, std::min(image_height_, (row + 1) * height));
  }
}

}  // namespace diminish
#endif
