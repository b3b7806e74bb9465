#include "bars/shadow_surfaces.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/channels.h"

namespace diminish {
namespace {

/// Vertices across the depth image.
constexpr int most_vertex_columns = 320;
/// The widest shadow, as a share of the image's width.
constexpr float widest_gap = 0.1F;
/// Corners of a triangle are of one surface if their distances differ by this share at most.
constexpr float same_surface = 0.05F;

/// Pixels of the user's picture whose nearest sample is kept.
constexpr int cell_px = 8;
/// What lies this much further away than that is hidden from the user.
constexpr float hidden_behind = 0.93F;
/// Pixels from the objects on in which their colours may be mixed with others.
constexpr int object_rim_px = 4;
/// Levels: colours that are alike, and how many places must have such; 10 to 20 % have by chance.
constexpr float alike = 15;
constexpr float least_alike_share = 0.35F;
constexpr int fewest_places = 100;
/// Of a camera's gaps, so many places at most are asked.
constexpr std::size_t most_places = 1000;

/// Four pixels of a depth image.
std::uint64_t four_depths(const std::uint16_t* depths) {
  static_assert(std::endian::native == std::endian::little, "the first pixel is the lowest");
  std::uint64_t four;
  std::memcpy(&four, depths, sizeof(four));
  return four;
}

/// The first of the pixels [x, end) that was measured; `end` if there is none.
int find_measured(const std::uint16_t* depths, int x, int end) {
  for (; x + 4 <= end; x += 4) {
    const std::uint64_t four = four_depths(depths + x);
    if (four != 0) return x + std::countr_zero(four) / 16;
  }
  while (x < end && depths[x] == 0) ++x;
  return x;
}

/// The first that was not.
int find_unmeasured(const std::uint16_t* depths, int x, int end) {
  constexpr std::uint64_t ones = 0x0001000100010001U;
  for (; x + 4 <= end; x += 4) {
    const std::uint64_t four = four_depths(depths + x);
    // The lowest of these bits is that of the first 0. Higher bits may be wrong.
    const std::uint64_t zeros = (four - ones) & ~four & (0x8000 * ones);
    if (zeros != 0) return x + std::countr_zero(zeros) / 16;
  }
  while (x < end && depths[x] != 0) ++x;
  return x;
}

bool is_object(const Mask& objects, int x, int y) {
  return objects.bounds().contains(x, y) && objects(x, y) != 0;
}

bool is_near_object(const Mask& objects, int x, int y) {
  for (const int dy : {-object_rim_px, 0, object_rim_px}) {
    for (const int dx : {-object_rim_px, 0, object_rim_px}) {
      if (is_object(objects, x + dx, y + dy)) return true;
    }
  }
  return false;
}

}  // namespace

ShadowSurfaces::Camera::Camera(const RgbdCamera& camera)
    : rays(RayTable::of(camera.depth)),
      unit_m(static_cast<float>(camera.depth_unit_m)),
      step((camera.depth.width + most_vertex_columns - 1) / most_vertex_columns),
      columns(camera.depth.width / step),
      rows(camera.depth.height / step) {}

ShadowSurfaces::ShadowSurfaces(const Rig& rig)
    : nearest_m_(rig.color.width / cell_px + 1, rig.color.height / cell_px + 1),
      own_nearest_m_(nearest_m_.width() + 2, nearest_m_.height() + 2) {
  for (const RgbdCamera& camera : rig.rgbd) cameras_.emplace_back(camera);
}

void ShadowSurfaces::find_hiding(std::span<const SceneSample> samples) {
  constexpr float nothing = std::numeric_limits<float>::max();
  std::fill_n(own_nearest_m_.data(), own_nearest_m_.size(), nothing);
  for (const SceneSample& sample : samples) {
    const int column = static_cast<int>(sample.pixel.x()) / cell_px + 1;
    const int row = static_cast<int>(sample.pixel.y()) / cell_px + 1;
    if (!own_nearest_m_.bounds().contains(column, row)) continue;
    own_nearest_m_(column, row) = std::min(own_nearest_m_(column, row), sample.point_m.z());
  }
  // First along columns, then along rows.
  std::vector<float>& column = nearest_in_column_m_;
  column.resize(static_cast<std::size_t>(own_nearest_m_.width()));
  const auto find = [](const float* a, const float* b, const float* c, int count, float* to) {
    for (int x = 0; x < count; ++x) to[x] = std::min(std::min(a[x], b[x]), c[x]);
  };
  for (int y = 0; y < nearest_m_.height(); ++y) {
    find(own_nearest_m_.row(y), own_nearest_m_.row(y + 1), own_nearest_m_.row(y + 2),
         own_nearest_m_.width(), column.data());
    find(column.data(), column.data() + 1, column.data() + 2, nearest_m_.width(),
         nearest_m_.row(y));
  }
}

void ShadowSurfaces::find_gaps(const GapScene& scene, std::size_t k, int row, Camera& camera) {
  const ImageView<std::uint16_t> depth = scene.frame.rgbd[k].depth;
  const Mask& objects = scene.masks.rgbd_depth[k];
  const int step = camera.step;
  const int y = row * step;
  const auto widest = static_cast<int>(widest_gap * static_cast<float>(depth.width()));
  const std::uint16_t* const depths = depth.row(y);
  // From one measured pixel to the next.
  for (int right = find_measured(depths, 0, depth.width());;) {
    const int left = find_unmeasured(depths, right, depth.width()) - 1;
    right = find_measured(depths, left + 1, depth.width());
    if (right == depth.width()) return;
    if (right - left <= widest && !is_object(objects, left, y) && !is_object(objects, right, y)) {
      const float depth_m =
          camera.unit_m * static_cast<float>(std::max(depths[left], depths[right]));
      const int last = std::min((right - 1) / step, camera.columns - 1);
      for (int column = left / step + 1; column <= last; ++column) {
        if (!is_object(objects, column * step, y)) camera.gaps.push_back({column, row, depth_m});
      }
    }
  }
}

ShadowSurfaces::Vertex ShadowSurfaces::vertex(const GapScene& scene, const Place& place,
                                              const Camera& camera) {
  const Eigen::Vector3f ray =
      (*camera.rays)(place.column * camera.step, place.row * camera.step).homogeneous();
  const Eigen::Vector3f point_m = transform(camera.user_from_depth, ray * place.depth_m);
  const auto at = scene.views.project(point_m);
  return at ? Vertex{*at, 1 / point_m.z(), place.depth_m, false} : Vertex{};
}

bool ShadowSurfaces::is_confirmed(const GapScene& scene, std::size_t k) const {
  const Camera& camera = cameras_[k];
  int places = 0;
  int alike_places = 0;
  const Rect inner = grow(scene.frame.color.bounds(), -object_rim_px);
  const std::size_t step = 1 + camera.gaps.size() / most_places;
  for (std::size_t i = 0; i < camera.gaps.size(); i += step) {
    const Vertex there = vertex(scene, camera.gaps[i], camera);
    const int x = static_cast<int>(there.at.x());
    const int y = static_cast<int>(there.at.y());
    if (!inner.contains(x, y) || is_near_object(scene.masks.color, x, y)) continue;
    if (nearest_m_(x / cell_px, y / cell_px) * there.inverse_m < hidden_behind) continue;
    const auto color = scene.views.color(k, scene.views.ray(x, y) / there.inverse_m);
    if (!color) continue;
    const Eigen::Array3f mapped = scene.color_maps[k + 1](*color, there.at.x(), there.at.y());
    const Eigen::Array3f difference = mapped - to_channels(scene.frame.color(x, y));
    ++places;
    alike_places += difference.abs().maxCoeff() < alike ? 1 : 0;
  }
  return places >= fewest_places &&
         static_cast<float>(alike_places) >= least_alike_share * static_cast<float>(places);
}

void ShadowSurfaces::make_vertices(const GapScene& scene, std::size_t k, Camera& camera) {
  if (camera.vertices.empty()) camera.vertices = Image<Vertex>(camera.columns, camera.rows);
  for (const Place& gap : camera.gaps) {
    Vertex& own = camera.vertices(gap.column, gap.row);
    own = vertex(scene, gap, camera);
    own.closes_gap = own.inverse_m > 0;
  }
  // What was measured next to gaps.
  for (const Place& gap : camera.gaps) {
    for (int row = gap.row - 1; row <= gap.row + 1; ++row) {
      for (int column = gap.column - 1; column <= gap.column + 1; ++column) {
        if (!camera.vertices.bounds().contains(column, row)) continue;
        Vertex& end = camera.vertices(column, row);
        if (end.inverse_m > 0) continue;
        const int x = column * camera.step;
        const int y = row * camera.step;
        const std::uint16_t measured = scene.frame.rgbd[k].depth(x, y);
        if (measured == 0 || is_object(scene.masks.rgbd_depth[k], x, y)) continue;
        const Place place{column, row, camera.unit_m * static_cast<float>(measured)};
        end = vertex(scene, place, camera);
        camera.ends.push_back(place);
      }
    }
  }
}

void ShadowSurfaces::find(const GapScene& scene) {
  find_hiding(scene.samples);
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    Camera& camera = cameras_[k];
    for (std::vector<Place>* const places : {&camera.gaps, &camera.ends}) {
      if (camera.is_confirmed) {
        for (const Place& place : *places) camera.vertices(place.column, place.row) = {};
      }
      places->clear();
    }
    camera.is_confirmed = false;
    if (!scene.views.centre(k)) continue;
    camera.user_from_depth = FloatTransform(*scene.poses.color_from_depth[k]);
    for (int row = 0; row < camera.rows; ++row) find_gaps(scene, k, row, camera);
    camera.is_confirmed = is_confirmed(scene, k);
    if (camera.is_confirmed) make_vertices(scene, k, camera);
  }
}

bool ShadowSurfaces::are_joined(const Vertex& a, const Vertex& b, const Vertex& c) {
  if (!a.closes_gap && !b.closes_gap && !c.closes_gap) return false;
  const auto [nearest, farthest] = std::minmax({a.depth_m, b.depth_m, c.depth_m});
  return nearest > 0 && farthest <= (1 + same_surface) * nearest;
}

}  // namespace diminish
