#include "scene/cast_shadows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/channels.h"
#include "core/rows.h"
#include "core/runs.h"
#include "core/tasks.h"
#include "depth/depth_noise.h"
#include "scene/surface_rows.h"

namespace diminish {
namespace {

constexpr float cell_m = CastShadows::cell_m;
constexpr int grid_cells = CastShadows::grid_cells;
/// Something this near a plane may be the plane.
constexpr float least_height_m = 0.02F;
constexpr std::size_t fewest_lit = 150;
constexpr std::size_t most_lit = 800;
constexpr std::size_t fewest_blockers = 15;
constexpr std::size_t most_blockers = 400;
/// Beams with a smaller share change nothing that is seen.
constexpr float smallest_beam = CastShadows::invisible;
/// With less light than this a shadow is visible.
constexpr float shadow = 0.97F;

constexpr DepthNoise noise;

/// In cells; cell centres are at whole numbers.
Eigen::Vector2f to_cells(const Eigen::Vector2f& place) {
  return place / cell_m + Eigen::Vector2f::Constant(grid_cells / 2.F);
}
Eigen::Vector2f to_place(int x, int y) {
  return cell_m * (Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y)) -
                   Eigen::Vector2f::Constant(grid_cells / 2.F));
}
/// The cell that contains a place, as a rectangle. It may lie outside the grid.
Rect cell_of(const Eigen::Vector2f& place) {
  const Eigen::Vector2f at = to_cells(place);
  return {static_cast<int>(std::lrint(at.x())), static_cast<int>(std::lrint(at.y())), 1, 1};
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

float CastShadows::Shadow::light_at(const Eigen::Vector3f& point_m) const {
  const Rect cell = cell_of(ground.coordinates(point_m));
  return light.bounds().contains(cell.x, cell.y) ? light(cell.x, cell.y).mean() : 1.F;
}

/// The cell on the point's line away from the light: what hides the cell hides the point, unless it
/// is lower.
bool CastShadows::Shadow::is_hidden(const Eigen::Vector3f& point_m, const Beam& beam) const {
  const float height_m = ground.plane.height_m(point_m);
  const Rect cell = cell_of(ground.coordinates(point_m - height_m * beam.toward));
  return light.bounds().contains(cell.x, cell.y) &&
         step_m * static_cast<float>(beam.height(cell.x, cell.y)) > height_m;
}

CastShadows::CastShadows(const Intrinsics& color) : lens_(color), rays_(color) {
  constexpr float degree = std::numbers::pi_v<float> / 180;
  Eigen::Index d = 0;
  for (const float elevation : elevations_deg) {
    for (int i = 0; i < azimuths; ++i, ++d) {
      const float azimuth = 360 * degree * static_cast<float>(i) / azimuths;
      slopes_u_[d] = std::cos(azimuth) / std::tan(elevation * degree);
      slopes_v_[d] = std::sin(azimuth) / std::tan(elevation * degree);
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
  searches_.resize(planes.size());
  for_tasks(planes.size(), [&](std::size_t k) {
    Search& search = searches_[k];
    const Ground ground(planes[k], middle);
    search.choose_blockers(ground, planes, object_points_m);
    search.choose_lit(ground, samples);
    search.found.ground = ground;
    search.is_found = search.find(slopes_u_, slopes_v_);
    if (!search.is_found) return;
    search.found.label = static_cast<std::uint8_t>(surface_label::first_plane + k);
  });
  for (Search& search : searches_) {
    if (!search.is_found) continue;
    if (shadows_.size() == shadow_count_) shadows_.emplace_back();
    std::swap(shadows_[shadow_count_++], search.found);
  }
}

/// The points that are on no plane.
void CastShadows::Search::choose_blockers(const Ground& ground,
                                          const std::vector<BackgroundPlane>& planes,
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

/// Uses the camera that sees most of the plane, because two cameras' colours differ.
void CastShadows::Search::choose_lit(const Ground& ground,
                                     const std::vector<SceneSample>& samples) {
  const auto is_on = [&](const SceneSample& sample) {
    return std::abs(ground.plane.height_m(sample.point_m)) <= 2 * noise.at(sample.point_m.z()) &&
           ground.coordinates(sample.point_m).cwiseAbs().maxCoeff() < cell_m * grid_cells / 2;
  };
  std::array<std::size_t, 256> by_source{};
  on_plane_.clear();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!is_on(samples[i])) continue;
    on_plane_.push_back(static_cast<std::uint32_t>(i));
    ++by_source[samples[i].source];
  }
  const auto most = std::max_element(by_source.begin(), by_source.end());
  const auto source = static_cast<std::uint8_t>(most - by_source.begin());
  const std::size_t step = 1 + *most / most_lit;
  lit_.clear();
  std::size_t count = 0;
  for (const std::uint32_t i : on_plane_) {
    const SceneSample& sample = samples[i];
    if (sample.source != source || count++ % step != 0) continue;
    lit_.push_back({ground.coordinates(sample.point_m), to_channels(sample.color)});
  }
}

bool CastShadows::Search::find(const ByDirection& slopes_u, const ByDirection& slopes_v) {
  if (blockers_.size() < fewest_blockers || lit_.size() < fewest_lit) return false;
  find_hidden(slopes_u, slopes_v);
  if (!fit()) return false;
  keep_beams(slopes_u, slopes_v);
  draw_light();
  return true;
}

template <class Visit>
void CastShadows::for_each_direction(const std::uint64_t* bits, const Visit& visit) {
  for (std::size_t word = 0; word < words; ++word) {
    for_each_bit(bits[word],
                 [&](int bit) { visit(bits_a_word * word + static_cast<std::size_t>(bit)); });
  }
}

/// A blocker is as large as a few cells: it darkens the cell that its shadow falls on and those
/// around it.
void CastShadows::Search::find_hidden(const ByDirection& slopes_u, const ByDirection& slopes_v) {
  constexpr int rim = 2;
  constexpr int width = grid_cells + 2 * rim;
  constexpr float last = width - 1;
  struck_.resize(words * width, width, 0);
  const ByDirection along_u = slopes_u / cell_m;
  const ByDirection along_v = slopes_v / cell_m;
  for (const Blocker& blocker : blockers_) {
    // Rounds: adds half a cell and truncates.
    const Eigen::Vector2f at = to_cells(blocker.place) + Eigen::Vector2f::Constant(rim + 0.5F);
    using Cells = Eigen::Array<int, directions, 1>;
    const Cells x = (at.x() - blocker.height_m * along_u).max(0.F).min(last).cast<int>();
    const Cells y = (at.y() - blocker.height_m * along_v).max(0.F).min(last).cast<int>();
    const Cells place = words * (width * y + x);
    for (std::size_t word = 0, first = 0; first < directions; ++word, first += bits_a_word) {
      std::uint64_t* const struck = struck_.data() + word;
      const std::size_t end = std::min<std::size_t>(first + bits_a_word, directions);
      std::uint64_t bit = 1;
      for (std::size_t d = first; d < end; ++d, bit <<= 1) {
        struck[place[static_cast<Eigen::Index>(d)]] |= bit;
      }
    }
  }
  hidden_.resize(words * grid_cells, grid_cells);
  struck_in_column_.resize(struck_.width(), 1);
  const auto unite = [](const std::uint64_t* a, const std::uint64_t* b, const std::uint64_t* c,
                        int count, std::uint64_t* to) {
    for (int i = 0; i < count; ++i) to[i] = a[i] | b[i] | c[i];
  };
  for (int y = 0; y < grid_cells; ++y) {
    std::uint64_t* const column = struck_in_column_.row(0);
    unite(struck_.row(y + rim - 1), struck_.row(y + rim), struck_.row(y + rim + 1), struck_.width(),
          column);
    const std::uint64_t* const first = column + std::ptrdiff_t{words} * rim;
    unite(first - words, first, first + words, hidden_.width(), hidden_.row(y));
  }
}

bool CastShadows::Search::fit() {
  fit_.begin(directions);
  for (const Lit& lit : lit_) {
    const Rect cell = cell_of(lit.place);
    const int x = std::clamp(cell.x, 0, grid_cells - 1);
    const int y = std::clamp(cell.y, 0, grid_cells - 1);
    hidden_from_.clear();
    for_each_direction(&hidden_(words * x, y), [&](std::size_t direction) {
      hidden_from_.push_back(static_cast<std::uint8_t>(direction));
    });
    fit_.add(lit.place, lit.levels, hidden_from_);
  }
  return fit_.fit();
}

void CastShadows::Search::keep_beams(const ByDirection& slopes_u, const ByDirection& slopes_v) {
  const Ground& ground = found.ground;
  float top_m = 0;
  for (const Blocker& blocker : blockers_) top_m = std::max(top_m, blocker.height_m);
  found.step_m = top_m / 255;
  found.beam_count_ = 0;
  for (std::size_t d = 0; d < directions; ++d) {
    const Eigen::Array3f share = fit_.share(d);
    if (share.mean() < smallest_beam) continue;
    if (found.beams_.size() == found.beam_count_) found.beams_.emplace_back();
    Beam& beam = found.beams_[found.beam_count_++];
    const auto i = static_cast<Eigen::Index>(d);
    const Eigen::Vector2f slope(slopes_u[i], slopes_v[i]);
    beam.toward = ground.plane.normal + slope.x() * ground.along_u + slope.y() * ground.along_v;
    beam.share = share;
    beam.height.resize(grid_cells, grid_cells, 0);
    for (const Blocker& blocker : blockers_) {
      const auto height = static_cast<std::uint8_t>(blocker.height_m / found.step_m);
      const Rect struck = intersect(grow(cell_of(blocker.place - blocker.height_m * slope), 1),
                                    beam.height.bounds());
      for (int y = struck.y; y < struck.bottom(); ++y) {
        for (int x = struck.x; x < struck.right(); ++x) {
          beam.height(x, y) = std::max(beam.height(x, y), height);
        }
      }
    }
  }
}

/// Adds up the hidden light, cell by cell.
void CastShadows::Search::draw_light() {
  Image<Eigen::Array3f>& light = found.light;
  std::array<Eigen::Array4f, directions> shares;
  std::array<std::uint64_t, words> has_share{};
  for (std::size_t d = 0; d < directions; ++d) {
    const Eigen::Array3f share = fit_.share(d);
    shares[d] = {share[0], share[1], share[2], 0};
    if (share.maxCoeff() > 0) {
      has_share[d / bits_a_word] |= std::uint64_t{1} << (d % bits_a_word);
    }
  }
  dark_.resize(grid_cells, grid_cells, Eigen::Array4f::Zero());
  Rect shaded;
  for (int y = 0; y < grid_cells; ++y) {
    const std::uint64_t* hidden = hidden_.row(y);
    int first = grid_cells;
    int last = -1;
    for (int x = 0; x < grid_cells; ++x, hidden += words) {
      const std::array<std::uint64_t, words> bits = {hidden[0] & has_share[0],
                                                     hidden[1] & has_share[1]};
      if ((bits[0] | bits[1]) == 0) continue;
      first = std::min(first, x);
      last = x;
      Eigen::Array4f dark = Eigen::Array4f::Zero();
      for_each_direction(bits.data(), [&](std::size_t direction) { dark += shares[direction]; });
      dark_(x, y) = dark;
    }
    if (last >= 0) shaded = join(shaded, {first, y, last + 1 - first, 1});
  }
  // Lights have a size, so take the mean of three by three cells.
  const Rect part = intersect(grow(shaded, 1), {1, 1, grid_cells - 2, grid_cells - 2});
  light.resize(grid_cells, grid_cells, Eigen::Array3f::Ones());
  for (int y = part.y; y < part.bottom(); ++y) {
    const Eigen::Array4f* const above = dark_.row(y - 1);
    const Eigen::Array4f* const own = dark_.row(y);
    const Eigen::Array4f* const below = dark_.row(y + 1);
    const auto column = [&](int x) { return Eigen::Array4f(above[x] + own[x] + below[x]); };
    Eigen::Array4f left = column(part.x - 1);
    Eigen::Array4f middle = column(part.x);
    for (int x = part.x; x < part.right(); ++x) {
      const Eigen::Array4f right = column(x + 1);
      const Eigen::Array4f left_over =
          (1 - (left + middle + right) / 9).max(ShadowFit::least_light);
      light(x, y) = {left_over[0], left_over[1], left_over[2]};
      left = middle;
      middle = right;
    }
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
        if (most >= invisible) is_shaded_(column, row) = 255;
      }
    }
  }
}

/// The share of the light that is lost at the point of the plane that a ray meets; 0 beyond the
/// grid.
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
