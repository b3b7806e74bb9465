#include "scene/cast_shadows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "core/rows.h"
#include "core/tasks.h"
#include "scene/surface_rows.h"

namespace diminish {
namespace {

/// With less light than this a shadow is visible.
constexpr float shadow = 0.97F;

}  // namespace

CastShadows::CastShadows(const Intrinsics& color) : lens_(color), rays_(color) {}

void CastShadows::find(const std::vector<BackgroundPlane>& planes,
                       const std::vector<SceneSample>& samples,
                       const std::vector<Eigen::Vector3f>& object_points_m) {
  shadow_count_ = 0;
  if (object_points_m.size() < ShadowSearch::fewest_blockers) return;
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : object_points_m) middle += point;
  middle /= static_cast<float>(object_points_m.size());
  searches_.resize(planes.size());
  are_found_.resize(planes.size());
  for_tasks(planes.size(), [&](std::size_t k) {
    const CastShadow::Ground ground(planes[k], middle);
    are_found_[k] = searches_[k].find({ground, planes, samples, object_points_m}) ? 1 : 0;
  });
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (are_found_[k] == 0) continue;
    if (shadows_.size() == shadow_count_) shadows_.emplace_back();
    CastShadow& found = shadows_[shadow_count_++];
    std::swap(found, searches_[k].found());
    found.label = static_cast<std::uint8_t>(surface_label::first_plane + k);
  }
}

Rect CastShadows::bounds() const {
  constexpr int step = 2;
  Rect box;
  for (std::size_t i = 0; i < shadow_count_; ++i) {
    const CastShadow& cast = shadows_[i];
    for (int y = 0; y < CastShadow::grid_cells; y += step) {
      for (int x = 0; x < CastShadow::grid_cells; x += step) {
        if (cast.light(x, y).minCoeff() > shadow) continue;
        const auto pixel =
            lens_.project(cast.ground.point_m(CastShadow::to_place(x, y)).cast<double>());
        if (!pixel) continue;
        extend(box, static_cast<int>(pixel->x()), static_cast<int>(pixel->y()));
      }
    }
  }
  constexpr int margin_px = 16;
  return intersect(grow(box, margin_px), lens_.intrinsics().bounds());
}

void CastShadows::shade(const Reconstruction& reconstruction, Surfaces& surfaces) {
  surfaces.light.resize(surfaces.label.width(), surfaces.label.height());
  const Rect& region = surfaces.region;
  find_nodes(region);
  for_rows(region.height, [&](Rows rows) {
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      shade_row(y, reconstruction.depth_m, surfaces);
    }
  });
}

void CastShadows::find_nodes(const Rect& region) {
  const int first_column = region.x / node_px;
  const int first_row = region.y / node_rows_px;
  nodes_box_ = {first_column, first_row, region.right() / node_px + 2 - first_column,
                region.bottom() / node_rows_px + 2 - first_row};
  for (std::size_t i = 0; i < shadow_count_; ++i) {
    const BackgroundPlane& plane = shadows_[i].ground.plane;
    nodes_[i].resize(nodes_box_.width, nodes_box_.height);
    for (int row = 0; row < nodes_box_.height; ++row) {
      for (int column = 0; column < nodes_box_.width; ++column) {
        const int x = (first_column + column) * node_px;
        const int y = (first_row + row) * node_rows_px;
        const Eigen::Vector2f ray = rays_.segment(x, y, x + 1).first;
        const Eigen::Array3f dark = dark_at(shadows_[i], ray);
        nodes_[i](column, row) = {dark[0], dark[1], dark[2], plane.normal.dot(ray.homogeneous())};
      }
    }
  }
  // A node's block lies between it and the next node.
  is_shaded_.resize(nodes_box_.width - 1, nodes_box_.height - 1, 0);
  for (std::size_t i = 0; i < shadow_count_; ++i) {
    const auto dark = [&](int column, int row) {
      return nodes_[i](column, row).head<3>().maxCoeff();
    };
    for (int row = 0; row < is_shaded_.height(); ++row) {
      for (int column = 0; column < is_shaded_.width(); ++column) {
        const float most = std::max(std::max(dark(column, row), dark(column + 1, row)),
                                    std::max(dark(column, row + 1), dark(column + 1, row + 1)));
        if (most >= CastShadow::invisible) is_shaded_(column, row) = 255;
      }
    }
  }
}

/// The share of the light that is lost at the point of the plane that a ray meets; 0 beyond the
/// grid.
Eigen::Array3f CastShadows::dark_at(const CastShadow& cast, const Eigen::Vector2f& ray) {
  const Eigen::Vector3f direction(ray.x(), ray.y(), 1);
  const float inverse = cast.ground.plane.inverse_depth(ray.x(), ray.y());
  if (!(inverse > 0)) return Eigen::Array3f::Zero();
  const Eigen::Vector2f at = CastShadow::to_cells(cast.ground.coordinates(direction / inverse));
  if (!(at.minCoeff() >= 0 && at.maxCoeff() < CastShadow::grid_cells - 1))
    return Eigen::Array3f::Zero();
  const int column = static_cast<int>(at.x());
  const int row = static_cast<int>(at.y());
  const Eigen::Array3f* upper = &cast.light(column, row);
  const Eigen::Array3f* lower = &cast.light(column, row + 1);
  const float u = at.x() - static_cast<float>(column);
  const float v = at.y() - static_cast<float>(row);
  return 1 -
         ((1 - v) * ((1 - u) * upper[0] + u * upper[1]) + v * ((1 - u) * lower[0] + u * lower[1]));
}

void CastShadows::shade_row(int y, const Image<float>& depth_m, Surfaces& surfaces) const {
  const Rect& region = surfaces.region;
  Bgr* const light = surfaces.light.row(y);
  std::fill_n(light + region.x, region.width, Bgr{255, 255, 255});
  const int row = y / node_rows_px - nodes_box_.y;
  const float below = static_cast<float>(y % node_rows_px) / node_rows_px;
  std::array<surface_rows::Shading, BackgroundPlanes::most_planes> shadings;
  for (int column = 0; column < is_shaded_.width(); ++column) {
    if (is_shaded_(column, row) == 0) continue;
    const int begin = (nodes_box_.x + column) * node_px;
    const int x = std::max(begin, region.x);
    const int count = std::min(begin + node_px, region.right()) - x;
    for (std::size_t i = 0; i < shadow_count_; ++i) {
      const Eigen::Array4f* const above = &nodes_[i](column, row);
      const Eigen::Array4f* const under = &nodes_[i](column, row + 1);
      const Eigen::Array4f left = above[0] + below * (under[0] - above[0]);
      const Eigen::Array4f right = above[1] + below * (under[1] - above[1]);
      surface_rows::Shading& shading = shadings[i];
      shading.label = shadows_[i].label;
      shading.distance_m = shadows_[i].ground.plane.distance_m;
      shading.fading_height = fading_height;
      shading.slope = (right - left) / node_px;
      shading.first = left + static_cast<float>(x - begin) * shading.slope;
    }
    surface_rows::shade({shadings.data(), shadow_count_}, depth_m.row(y) + x,
                        surfaces.label.row(y) + x, count, light + x);
  }
}

}  // namespace diminish
