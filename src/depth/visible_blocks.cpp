#include "depth/visible_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rows.h"
#include "geometry/point_projection.h"
#include "geometry/ray_table.h"
#include "geometry/shared_table.h"

#ifndef DIMINISH_DEPTH_VISIBLE_BLOCKS_COLUMNS
#define DIMINISH_DEPTH_VISIBLE_BLOCKS_COLUMNS
namespace diminish {
/// That FindDepths may read and write beyond a row's end.
constexpr int columns_ahead = 32;
}  // namespace diminish
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "depth/visible_blocks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace diminish::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The nearest and the farthest depth of some rows, of each column and the next 15; 65535 and 0
/// where there is none. nearest, farthest: `columns_ahead` longer than the rows.
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
  const hn::CappedTag<std::uint16_t, columns_ahead / 2> d;
  const auto lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= columns; x += lanes) find(d, x);
  for (; x < columns; ++x) find(hn::CappedTag<std::uint16_t, 1>(), x);
  std::fill_n(nearest + columns, columns_ahead, std::uint16_t{65535});
  std::fill_n(farthest + columns, columns_ahead, std::uint16_t{0});
  for (const int ahead : {1, 2, 4, 8}) {
    for (x = 0; x < columns; x += lanes) {
      hn::StoreU(hn::Min(hn::LoadU(d, nearest + x), hn::LoadU(d, nearest + x + ahead)), d,
                 nearest + x);
      hn::StoreU(hn::Max(hn::LoadU(d, farthest + x), hn::LoadU(d, farthest + x + ahead)), d,
                 farthest + x);
    }
  }
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
      projection_(color_),
      unit_m_(static_cast<float>(camera.depth_unit_m)),
      image_width_(camera.depth.width),
      image_height_(camera.depth.height) {
  visible_.resize((image_width_ + width - 1) / width, (image_height_ + height - 1) / height);
  rays_ = shared_table<BlockRays>(camera.depth);
  depth_m_.resize(rays_->of_block.size());
}

VisibleBlocks::BlockRays::BlockRays(const Intrinsics& depth) {
  const std::shared_ptr<const RayTable> rays = RayTable::of(depth);
  for (int row = 0; row * height < depth.height; ++row) {
    for (int column = 0; column * width < depth.width; ++column) {
      // A block is small: its other rays lie beyond these by less than the margin.
      const Rect pixels = with_neighbours(column, row, depth.bounds());
      Eigen::Array2f least = (*rays)(pixels.x, pixels.y);
      Eigen::Array2f greatest = least;
      for (const int y : {pixels.y, pixels.y + pixels.height / 2, pixels.bottom() - 1}) {
        for (const int x : {pixels.x, pixels.x + pixels.width / 2, pixels.right() - 1}) {
          const Eigen::Array2f ray = (*rays)(x, y);
          least = least.min(ray);
          greatest = greatest.max(ray);
        }
      }
      of_block.push_back({{least.x(), greatest.x()}, {least.y(), greatest.y()}});
    }
  }
}

void VisibleBlocks::begin(const RigidTransform& color_from_depth, const Rect& region) {
  color_from_depth_ = color_from_depth;
  to_color_ = FloatTransform(color_from_depth);
  sides_ = {};
  for (const int axis : {0, 1}) add_sides(region, axis, sides_);
}

void VisibleBlocks::find(float nearest_m, float farthest_m, const RigidTransform& color_from_depth,
                         const Rect& region) {
  begin(color_from_depth, region);
  for (int row = 0; row < visible_.rows(); ++row) {
    for (int column = 0; column < visible_.columns(); ++column) {
      const Range depth_m = {nearest_m, farthest_m};
      depth_m_[visible_.index(column, row)] = depth_m;
      visible_(column, row) =
          is_inside(sides_, rays_->of_block[visible_.index(column, row)], depth_m) ? 1 : 0;
    }
  }
  find_part();
}

void VisibleBlocks::find(ImageView<std::uint16_t> depth, const RigidTransform& color_from_depth,
                         const TiledRegion& region, int further_px) {
  begin(color_from_depth, grow(region, further_px));
  // Where nearly all tiles are kept, few blocks would be left out for them.
  const std::vector<std::uint8_t>& tiles = region.kept_tiles();
  const bool has_gaps = 4 * std::count(tiles.begin(), tiles.end(), 0) > std::ssize(tiles);
  const auto pitch = depth.stride() / std::ptrdiff_t{sizeof(std::uint16_t)};
  for_rows(image_height_, [&](Rows rows) {
    Depths& depths = depths_[rows.band];
    depths.nearest.resize(static_cast<std::size_t>(image_width_) + columns_ahead);
    depths.farthest.resize(depths.nearest.size());
    for (int row = rows.first / height; row * height < rows.last; ++row) {
      const Rect band = with_neighbours(0, row, depth.bounds());
      HWY_DYNAMIC_DISPATCH(FindDepths)
      (depth.row(band.y), pitch, band.height, depth.width(), depths.nearest.data(),
       depths.farthest.data());
      for (int column = 0; column < visible_.columns(); ++column) {
        const Rect pixels = with_neighbours(column, row, depth.bounds());
        // A block and its neighbours, of fewer than 32 columns.
        const auto first = static_cast<std::size_t>(pixels.x);
        const auto second = static_cast<std::size_t>(std::max(pixels.x, pixels.right() - width));
        const std::uint16_t nearest = std::min(depths.nearest[first], depths.nearest[second]);
        const std::uint16_t farthest = std::max(depths.farthest[first], depths.farthest[second]);
        Range& depth_m = depth_m_[visible_.index(column, row)];
        depth_m = {static_cast<float>(nearest) * unit_m_, static_cast<float>(farthest) * unit_m_};
        const Rays& rays = rays_->of_block[visible_.index(column, row)];
        const bool is_visible = farthest > 0 && is_inside(sides_, rays, depth_m) &&
                                (!has_gaps || touches(region, further_px, rays, depth_m));
        visible_(column, row) = is_visible ? 1 : 0;
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

/// Whether the body's box in the picture may touch the region.
bool VisibleBlocks::touches(const TiledRegion& region, int further_px, const Rays& rays,
                            const Range& depth_m) const {
  Eigen::Array2f least = Eigen::Array2f::Constant(farthest_px);
  Eigen::Array2f greatest = -least;
  for (const float z : {depth_m.least, depth_m.greatest}) {
    for (const float x : {rays.x.least, rays.x.greatest}) {
      for (const float y : {rays.y.least, rays.y.greatest}) {
        const Eigen::Vector3f point = transform(to_color_, {x * z, y * z, z});
        if (!(point.z() > nearest_seen_m)) return true;
        const Eigen::Array2f ray = point.array().head<2>() / point.z();
        least = least.min(ray);
        greatest = greatest.max(ray);
      }
    }
  }
  Eigen::Array2f first = Eigen::Array2f::Constant(farthest_px);
  Eigen::Array2f last = -first;
  for (const float x : {least.x(), greatest.x()}) {
    for (const float y : {least.y(), greatest.y()}) {
      Eigen::Array2f at;
      if (!projection_.distort(x, y, at.x(), at.y())) return true;
      first = first.min(at);
      last = last.max(at);
    }
  }
  // Lenses bend the sides of long boxes.
  constexpr float bend = 1.F / 16;
  const float margin =
      static_cast<float>(margin_px + further_px) + bend * (last - first).maxCoeff();
  if (!(margin < farthest_px)) return true;
  const Eigen::Array2i corner = (first - margin).cast<int>();
  const Eigen::Array2i size = (last + margin).cast<int>() - corner;
  return region.touches({corner.x(), corner.y(), size.x(), size.y()});
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
