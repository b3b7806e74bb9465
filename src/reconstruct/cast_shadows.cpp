#include "reconstruct/cast_shadows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/channels.h"
#include "core/rows.h"
#include "reconstruct/depth_noise.h"
#include "reconstruct/surface_rows.h"

namespace diminish {
namespace {

constexpr float cell_m = CastShadows::cell_m;
constexpr int grid_cells = CastShadows::grid_cells;
/// What is this near a plane may be the plane.
constexpr float least_height_m = 0.02F;
constexpr std::size_t fewest_lit = 150;
constexpr std::size_t most_lit = 800;
constexpr std::size_t fewest_blockers = 15;
constexpr std::size_t most_blockers = 400;
/// Less light than this is a shadow to see.
constexpr float shadow = 0.97F;

constexpr DepthNoise noise;

/// In cells; the middles of cells are at whole numbers.
Eigen::Vector2f to_cells(const Eigen::Vector2f& place) {
  return place / cell_m + Eigen::Vector2f::Constant(grid_cells / 2);
}
Eigen::Vector2f to_place(int x, int y) {
  return cell_m * (Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y)) -
                   Eigen::Vector2f::Constant(grid_cells / 2));
}
/// The cell that holds a place, as a rectangle; it may lie outside the grid.
Rect cell_of(const Eigen::Vector2f& place) {
  const Eigen::Vector2f at = to_cells(place);
  return {static_cast<int>(std::lrint(at.x())), static_cast<int>(std::lrint(at.y())), 1, 1};
}
std::array<std::uint64_t, 2> either(const std::array<std::uint64_t, 2>& a,
                                    const std::array<std::uint64_t, 2>& b,
                                    const std::array<std::uint64_t, 2>& c) {
  return {a[0] | b[0] | c[0], a[1] | b[1] | c[1]};
}

}  // namespace

CastShadows::Ground::Ground(const BackgroundPlane& plane_, const Eigen::Vector3f& middle)
    : plane(plane_), origin(middle - plane_.height_m(middle) * plane_.normal) {
  const Eigen::Vector3f& normal = plane.normal;
  const Eigen::Vector3f axis =
      std::abs(normal.x()) < 0.7F ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY();
  along_u = (axis - axis.dot(normal) * normal).normalized();
  along_v = normal.cross(along_u);
}
Eigen::Vector2f CastShadows::Ground::coordinates(const Eigen::Vector3f& point_m) const {
  const Eigen::Vector3f offset = point_m - origin;
  return {along_u.dot(offset), along_v.dot(offset)};
}
Eigen::Vector3f CastShadows::Ground::point_m(const Eigen::Vector2f& place) const {
  return origin + place.x() * along_u + place.y() * along_v;
}

CastShadows::CastShadows(const Intrinsics& color) : lens_(color), rays_(color) {
  constexpr float degree = std::numbers::pi_v<float> / 180;
  constexpr int azimuths = 16;
  for (const float elevation : {25.F, 38.F, 51.F, 64.F, 77.F}) {
    for (int i = 0; i < azimuths; ++i) {
      const float azimuth = 360 * degree * static_cast<float>(i) / azimuths;
      slopes_.push_back(Eigen::Vector2f(std::cos(azimuth), std::sin(azimuth)) /
                        std::tan(elevation * degree));
    }
  }
}

void CastShadows::find(const std::vector<BackgroundPlane>& planes,
                       const std::vector<SceneSample>& samples,
                       const std::vector<Eigen::Vector3f>& object_points_m) {
  shadow_count_ = 0;
  if (object_points_m.size() < fewest_blockers) return;
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : object_points_m) middle += point;
  middle /= static_cast<float>(object_points_m.size());
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const Ground ground(planes[k], middle);
    choose_blockers(ground, planes, object_points_m);
    choose_lit(ground, samples);
    if (blockers_.size() < fewest_blockers || lit_.size() < fewest_lit) continue;
    if (!fit()) continue;
    if (shadows_.size() == shadow_count_) shadows_.emplace_back();
    Shadow& found = shadows_[shadow_count_++];
    found.ground = ground;
    found.label = static_cast<std::uint8_t>(surface_label::first_plane + k);
    draw_light(found.light);
  }
}

/// What is on none of the planes.
void CastShadows::choose_blockers(const Ground& ground, const std::vector<BackgroundPlane>& planes,
                                  const std::vector<Eigen::Vector3f>& object_points_m) {
  blockers_.clear();
  const std::size_t step = 1 + object_points_m.size() / most_blockers;
  for (std::size_t i = 0; i < object_points_m.size(); i += step) {
    const Eigen::Vector3f& point = object_points_m[i];
    const bool stands_out = std::all_of(planes.begin(), planes.end(), [&](const auto& plane) {
      return plane.height_m(point) >= least_height_m + noise.at(point.z());
    });
    if (stands_out) blockers_.push_back({ground.coordinates(point), ground.plane.height_m(point)});
  }
}

/// Of the camera that sees most of the plane: two cameras' colours differ.
void CastShadows::choose_lit(const Ground& ground, const std::vector<SceneSample>& samples) {
  const auto is_on = [&](const SceneSample& sample) {
    return std::abs(ground.plane.height_m(sample.point_m)) <= 2 * noise.at(sample.point_m.z()) &&
           ground.coordinates(sample.point_m).cwiseAbs().maxCoeff() < cell_m * grid_cells / 2;
  };
  std::array<std::size_t, 256> by_source{};
  for (const SceneSample& sample : samples) by_source[sample.source] += is_on(sample) ? 1U : 0U;
  const auto most = std::max_element(by_source.begin(), by_source.end());
  const auto source = static_cast<std::uint8_t>(most - by_source.begin());
  const std::size_t step = 1 + *most / most_lit;
  lit_.clear();
  std::size_t count = 0;
  for (const SceneSample& sample : samples) {
    if (sample.source != source || !is_on(sample) || count++ % step != 0) continue;
    lit_.push_back({ground.coordinates(sample.point_m), to_channels(sample.color)});
  }
}

/// Blockers are as large as a few cells: what one hides is the cell that its shadow falls on, and
/// those around it.
void CastShadows::find_hidden() {
  constexpr Rect wider = {0, 0, grid_cells + 2, grid_cells + 2};
  struck_.resize(wider.width, wider.height, DirectionBits{});
  for (std::size_t d = 0; d < slopes_.size(); ++d) {
    const std::uint64_t bit = std::uint64_t{1} << (d % bits_a_word);
    for (const Blocker& blocker : blockers_) {
      const Rect cell = cell_of(blocker.place - blocker.height_m * slopes_[d]);
      if (!wider.contains(cell.x + 1, cell.y + 1)) continue;
      struck_(cell.x + 1, cell.y + 1)[d / bits_a_word] |= bit;
    }
  }
  hidden_.resize(grid_cells, grid_cells);
  struck_in_column_.resize(wider.width, 1);
  for (int y = 0; y < grid_cells; ++y) {
    DirectionBits* column = struck_in_column_.row(0);
    for (int x = 0; x < wider.width; ++x) {
      column[x] = either(struck_(x, y), struck_(x, y + 1), struck_(x, y + 2));
    }
    for (int x = 0; x < grid_cells; ++x) {
      hidden_(x, y) = either(column[x], column[x + 1], column[x + 2]);
    }
  }
}

bool CastShadows::fit() {
  find_hidden();
  fit_.begin(slopes_.size());
  for (const Lit& lit : lit_) {
    const Rect cell = cell_of(lit.place);
    const int x = std::clamp(cell.x, 0, grid_cells - 1);
    const int y = std::clamp(cell.y, 0, grid_cells - 1);
    directions_.clear();
    for (std::size_t d = 0; d < slopes_.size(); ++d) {
      if (is_hidden(x, y, d)) directions_.push_back(static_cast<std::uint8_t>(d));
    }
    fit_.add(lit.place, lit.levels, directions_);
  }
  return fit_.fit();
}

/// Adds up, cell by cell, what is hidden.
void CastShadows::draw_light(Image<Eigen::Array3f>& light) {
  shares_.clear();
  for (std::size_t d = 0; d < slopes_.size(); ++d) shares_.push_back(fit_.share(d));
  dark_.resize(grid_cells, grid_cells, Eigen::Array3f::Zero());
  for (std::size_t i = 0; i < dark_.size(); ++i) {
    for (std::size_t word = 0; word < hidden_.data()[i].size(); ++word) {
      for (std::uint64_t bits = hidden_.data()[i][word]; bits != 0; bits &= bits - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(bits));
        dark_.data()[i] += shares_[bits_a_word * word + bit];
      }
    }
  }
  // Lights have a size: the mean of three by three cells, first along rows.
  light.resize(grid_cells, grid_cells, Eigen::Array3f::Zero());
  for (int y = 0; y < grid_cells; ++y) {
    const Eigen::Array3f* dark = dark_.row(y);
    Eigen::Array3f* sum = light.row(y);
    for (int x = 1; x < grid_cells - 1; ++x) sum[x] = dark[x - 1] + dark[x] + dark[x + 1];
  }
  dark_.fill(Eigen::Array3f::Zero());
  for (int y = 1; y < grid_cells - 1; ++y) {
    Eigen::Array3f* mean = dark_.row(y);
    for (int x = 1; x < grid_cells - 1; ++x) {
      mean[x] = (light(x, y - 1) + light(x, y) + light(x, y + 1)) / 9;
    }
  }
  for (std::size_t i = 0; i < light.size(); ++i) {
    light.data()[i] = (1 - dark_.data()[i]).max(ShadowFit::least_light);
  }
}

Rect CastShadows::bounds() const {
  constexpr int step = 2;
  Rect box;
  for (std::size_t i = 0; i < shadow_count_; ++i) {
    const Shadow& cast = shadows_[i];
    for (int y = 0; y < grid_cells; y += step) {
      for (int x = 0; x < grid_cells; x += step) {
        if (cast.light(x, y).minCoeff() > shadow) continue;
        const auto pixel = lens_.project(cast.ground.point_m(to_place(x, y)).cast<double>());
        if (!pixel) continue;
        extend(box, static_cast<int>(pixel->x()), static_cast<int>(pixel->y()));
      }
    }
  }
  constexpr int margin_px = 16;
  return intersect(grow(box, margin_px), lens_.intrinsics().bounds());
}

void CastShadows::shade(Reconstruction& reconstruction) const {
  Image<Bgr>& light = reconstruction.light;
  light.resize(reconstruction.surface.width(), reconstruction.surface.height());
  const Rect& region = reconstruction.region;
  for_rows(region.height, [&](Rows rows) {
    for (int y = region.y + rows.first; y < region.y + rows.last; ++y) {
      std::fill_n(light.row(y) + region.x, region.width, Bgr{255, 255, 255});
      for (std::size_t i = 0; i < shadow_count_; ++i) shade_row(shadows_[i], y, reconstruction);
    }
  });
}

/// The share of the light that is taken from the plane's point that a ray meets; 0 beyond the grid.
Eigen::Array3f CastShadows::dark_at(const Shadow& cast, const Eigen::Vector2f& ray) {
  const Eigen::Vector3f direction(ray.x(), ray.y(), 1);
  const float inverse = cast.ground.plane.inverse_depth(ray.x(), ray.y());
  if (!(inverse > 0)) return Eigen::Array3f::Zero();
  const Eigen::Vector2f at = to_cells(cast.ground.coordinates(direction / inverse));
  if (!(at.minCoeff() >= 0 && at.maxCoeff() < grid_cells - 1)) return Eigen::Array3f::Zero();
  const int column = static_cast<int>(at.x());
  const int row = static_cast<int>(at.y());
  const Eigen::Array3f* upper = &cast.light(column, row);
  const Eigen::Array3f* lower = &cast.light(column, row + 1);
  const float u = at.x() - static_cast<float>(column);
  const float v = at.y() - static_cast<float>(row);
  return 1 -
         ((1 - v) * ((1 - u) * upper[0] + u * upper[1]) + v * ((1 - u) * lower[0] + u * lower[1]));
}

void CastShadows::shade_row(const Shadow& cast, int y, Reconstruction& reconstruction) const {
  const Rect& region = reconstruction.region;
  const std::uint8_t* surface = reconstruction.surface.row(y);
  surface_rows::Shading shading;
  shading.label = cast.label;
  shading.plane = cast.ground.plane;
  shading.fading_height = fading_height;
  for (int begin = region.x; begin < region.right();) {
    const RayGrid::Segment rays = rays_.segment(begin, y, region.right());
    shading.slope = rays.slope;
    for (int first = 0; first < rays.count; first += node_px) {
      const int x = begin + first;
      const int count = std::min(node_px, rays.count - first);
      if (std::find(surface + x, surface + x + count, cast.label) == surface + x + count) continue;
      shading.ray = rays.first + static_cast<float>(first) * rays.slope;
      shading.dark = dark_at(cast, shading.ray);
      const Eigen::Array3f right = dark_at(cast, shading.ray + float{node_px} * rays.slope);
      if (std::max(shading.dark.maxCoeff(), right.maxCoeff()) < invisible) continue;
      shading.dark_slope = (right - shading.dark) / node_px;
      surface_rows::shade(shading, reconstruction.depth_m.row(y) + x, surface + x, count,
                          reconstruction.light.row(y) + x);
    }
    begin += rays.count;
  }
}

}  // namespace diminish
