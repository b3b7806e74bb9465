#include "scene/thing_light.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/runs.h"
#include "geometry/symmetric_solver.h"

namespace diminish {
namespace {

/// Blocks to each side that may belong to the same surface.
constexpr int reach = 1;
/// Of the depth, between blocks of one surface.
constexpr float largest_step = 0.02F;
constexpr int fewest_blocks = 5;
/// A thing gets light from its surroundings that the plane does not get, from the plane itself
/// above all. So what the beams lose counts less. Between .5 and .75 scores hardly differ.
constexpr float share_of_beams = 2 / 3.F;
/// Rows of blocks.
constexpr int block_rows_together = 8;

/// The direction that a surface faces at a block, towards the camera; 0 if it is unknown. Along a
/// plane the inverse depth is linear in the ray. ray_step: from block to block.
Eigen::Vector3f facing(const Image<float>& inverse_depth, int column, int row,
                       const Eigen::Vector2f& ray, float ray_step) {
  const float own = inverse_depth(column, row);
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  Eigen::Vector3f products = Eigen::Vector3f::Zero();
  int count = 0;
  const int left = std::max(column - reach, 0);
  const int right = std::min(column + reach, inverse_depth.width() - 1);
  for (int y = std::max(row - reach, 0); y <= std::min(row + reach, inverse_depth.height() - 1);
       ++y) {
    for (int x = left; x <= right; ++x) {
      const float step = inverse_depth(x, y) - own;
      if (std::abs(step) > largest_step * own) continue;
      const Eigen::Vector3f at(1, static_cast<float>(x - column), static_cast<float>(y - row));
      squares += at * at.transpose();
      products += step * at;
      ++count;
    }
  }
  if (count < fewest_blocks || squares.determinant() < 1) return Eigen::Vector3f::Zero();
  const Eigen::Vector3f fit = solve_symmetric(squares, products);
  const Eigen::Vector2f slope = fit.tail<2>() / ray_step;
  // For a plane at n . point = 1, n . ray = 1 / z; -n faces the camera.
  return -Eigen::Vector3f(slope.x(), slope.y(), own + fit[0] - slope.dot(ray)).normalized();
}

/// The share of the light that is left at a point of a surface.
Eigen::Array3f light_on(const Eigen::Vector3f& point_m, const Eigen::Vector3f& normal,
                        const CastShadow& shadow) {
  Eigen::Array3f all = Eigen::Array3f::Ones();
  Eigen::Array3f dark = Eigen::Array3f::Zero();
  for (const CastShadow::Beam& beam : shadow.beams()) {
    const float facing = std::clamp(normal.dot(beam.toward), 0.F, 1.F);
    all -= (1 - facing) * beam.share;
    if (facing > 0 && shadow.is_hidden(point_m, beam)) dark += facing * beam.share;
  }
  return (1 - share_of_beams * dark / all).max(ShadowFit::least_light);
}

}  // namespace

void ThingLight::shade(std::span<const CastShadow> shadows, const RayGrid& rays,
                       const Image<float>& depth_m, Surfaces& surfaces) {
  find_depths(depth_m, surfaces);
  if (!find_light(shadows, rays, surfaces.region)) return;
  smooth();
  apply(surfaces);
}

void ThingLight::find_depths(const Image<float>& depth_m, const Surfaces& surfaces) {
  const Rect& region = surfaces.region;
  inverse_depth_.resize(region.width / block_px, region.height / block_px, 0);
  for_row_groups(inverse_depth_.height(), block_rows_together, [&](Rows rows) {
    for (int row = rows.first; row < rows.last; ++row) {
      for (int column = 0; column < inverse_depth_.width(); ++column) {
        const int left = region.x + column * block_px;
        float sum = 0;
        int count = 0;
        for (int y = region.y + row * block_px; y < region.y + (row + 1) * block_px; ++y) {
          const std::uint8_t* const label = surfaces.label.row(y);
          const float* const depth = depth_m.row(y);
          for (int x = left; x < left + block_px; ++x) {
            if (label[x] != surface_label::foreground || !(depth[x] > 0)) continue;
            sum += depth[x];
            ++count;
          }
        }
        if (count > 0) inverse_depth_(column, row) = static_cast<float>(count) / sum;
      }
    }
  });
}

/// Returns whether any is lost.
bool ThingLight::find_light(std::span<const CastShadow> shadows, const RayGrid& rays,
                            const Rect& region) {
  light_.resize(inverse_depth_.width(), inverse_depth_.height());
  std::atomic<bool> is_any_shaded = false;
  for_row_groups(light_.height(), block_rows_together, [&](Rows rows) {
    bool is_shaded_here = false;
    for (int row = rows.first; row < rows.last; ++row) {
      for (int column = 0; column < light_.width(); ++column) {
        Levels& light = light_(column, row);
        light.setZero();
        const float inverse_depth = inverse_depth_(column, row);
        if (inverse_depth == 0) continue;
        light.setOnes();
        const int x = region.x + column * block_px + block_px / 2;
        const int y = region.y + row * block_px + block_px / 2;
        const RayGrid::Segment segment = rays.segment(x, y, x + 1);
        const Eigen::Vector3f point_m = segment.first.homogeneous() / inverse_depth;
        const auto is_shaded = [&](const CastShadow& shadow) {
          return std::any_of(shadow.beams().begin(), shadow.beams().end(),
                             [&](const auto& beam) { return shadow.is_hidden(point_m, beam); });
        };
        if (std::none_of(shadows.begin(), shadows.end(), is_shaded)) continue;
        const Eigen::Vector3f normal =
            facing(inverse_depth_, column, row, segment.first, block_px * segment.slope.x());
        for (const CastShadow& shadow : shadows) {
          light.head<3>() = light.head<3>().min(light_on(point_m, normal, shadow));
        }
        is_shaded_here |= light.head<3>().minCoeff() < 1 - CastShadow::invisible;
      }
    }
    if (is_shaded_here) is_any_shaded.store(true, std::memory_order_relaxed);
  });
  return is_any_shaded;
}

/// The mean of what is known in three by three blocks: lights have a size.
void ThingLight::smooth() {
  smooth_.resize(light_.width(), light_.height());
  for (int row = 0; row < light_.height(); ++row) {
    for (int column = 0; column < light_.width(); ++column) {
      Levels sum = Levels::Zero();
      const int right = std::min(column + 1, light_.width() - 1);
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, light_.height() - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= right; ++x) sum += light_(x, y);
      }
      smooth_(column, row) = sum[3] > 0 ? Levels(sum / sum[3]) : Levels(Levels::Ones());
    }
  }
}

/// Bilinear between the blocks' centres.
void ThingLight::apply(Surfaces& surfaces) const {
  const Rect& region = surfaces.region;
  const int last_column = smooth_.width() - 1;
  const int last_row = smooth_.height() - 1;
  for_rows(region.height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      const std::uint8_t* const label = surfaces.label.row(region.y + y) + region.x;
      Bgr* const light = surfaces.light.row(region.y + y) + region.x;
      const int above = (y + block_px / 2) / block_px - 1;
      const float below =
          (static_cast<float>(y) + 0.5F) / block_px - 0.5F - static_cast<float>(above);
      const auto between = [&](int column) -> Levels {
        const int x = std::clamp(column, 0, last_column);
        const Levels& upper = smooth_(x, std::clamp(above, 0, last_row));
        return upper + below * (smooth_(x, std::min(above + 1, last_row)) - upper);
      };
      for (int x = 0, end;
           (x = find_equal(label, x, region.width, surface_label::foreground)) < region.width;
           x = end) {
        // Between the centres of two blocks; the last reaches to the end.
        const int column = std::min((x + block_px / 2) / block_px - 1, last_column);
        const int first = block_px * column + block_px / 2;
        end = column == last_column ? region.width : first + block_px;
        const Levels left = between(column);
        const Levels right = between(column + 1);
        if (left.min(right).head<3>().minCoeff() >= 1 - CastShadow::invisible) continue;
        const Levels step = 255 * (right - left) / block_px;
        Levels level = 255 * left + 0.5F * step + 0.5F;
        for (int i = first; i < end; ++i, level += step) {
          if (i < x || label[i] != surface_label::foreground) continue;
          const Eigen::Array4i rounded = level.cast<int>();
          light[i] = {static_cast<std::uint8_t>(rounded[0]), static_cast<std::uint8_t>(rounded[1]),
                      static_cast<std::uint8_t>(rounded[2])};
        }
      }
    }
  });
}

}  // namespace diminish
