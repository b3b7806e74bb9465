#include "memory/measured_depth.h"

#include <algorithm>
#include <cmath>

#include "core/conditions.h"
#include "core/rows.h"
#include "core/tasks.h"
#include "depth/depth_rows.h"
#include "geometry/every.h"
#include "geometry/point_rows.h"

namespace diminish {
namespace {

/// Further away than anything.
constexpr float nothing_m = 1e9F;

/// Whether a place lies behind two others of one surface: seen through a gap between its points.
bool is_behind(float z_m, float before_m, float after_m) {
  const float nearer_m = std::max(before_m, after_m);
  const float tolerance_m = between_cameras.at(nearer_m);
  return all_of(std::min(before_m, after_m) > 0, z_m - nearer_m > 2 * tolerance_m,
                std::abs(before_m - after_m) < tolerance_m);
}

/// Leaves out what is seen through gaps. All but `depth_m` have a place more on both sides.
void close_row(const float* own_m, const float* above_m, const float* below_m, int width,
               float* depth_m) {
  for (int x = 0; x < width; ++x) {
    const float z_m = own_m[x];
    const bool is_open =
        any_of(is_behind(z_m, own_m[x - 1], own_m[x + 1]), is_behind(z_m, above_m[x], below_m[x]));
    depth_m[x] = is_open ? 0 : z_m;
  }
}

/// The depths of every `step`-th pixel, without those that are masked.
void read_row(const std::uint16_t* measured, const std::uint8_t* masked, int width, int step,
              float unit_m, float* depth_m) {
  if (step == 1) {
    for (int x = 0; x < width; ++x) {
      depth_m[x] = static_cast<float>(masked[x] == 0 ? measured[x] : 0) * unit_m;
    }
    return;
  }
  for (int x = 0; x < width; ++x) {
    const std::ptrdiff_t at = std::ptrdiff_t{x} * step;
    depth_m[x] = static_cast<float>(masked[at] == 0 ? measured[at] : 0) * unit_m;
  }
}

}  // namespace

MeasuredDepth::MeasuredDepth(const Rig& rig, const KeyframeGrid& grid) : grid_(grid) {
  for (const RgbdCamera& of_rig : rig.rgbd) {
    Camera& camera = cameras_.emplace_back();
    const double finer = of_rig.depth.fx / grid.intrinsics().fx;
    // Two points along a place, so that noise is averaged.
    camera.step = std::max(1, static_cast<int>(finer / 2));
    camera.unit_m = static_cast<float>(of_rig.depth_unit_m);
    camera.magnified = static_cast<float>(camera.step / finer);
    camera.rays = RayTable::of(every(camera.step, of_rig.depth));
  }
}

void MeasuredDepth::find_places(const RgbdFrame& images, const RigidTransform& color_from_depth,
                                const Mask& mask, bool remove_flying, Camera& camera) const {
  constexpr int reach = depth_rows::reach;
  const ImageView<std::uint16_t> depth = images.depth;
  const auto pitch = static_cast<int>(depth.stride() / std::ptrdiff_t{sizeof(std::uint16_t)});
  const int width = camera.rays->width();
  const int height = camera.rays->height();
  camera.own_m.resize(width, height);
  camera.z_m.resize(width, height);
  camera.place.resize(width, height);
  const Rect& bounds = grid_.intrinsics().bounds();
  const PointView view{FloatTransform(color_from_depth), grid_.lens(), bounds, bounds.width};
  for_rows(height, [&](Rows rows) {
    std::vector<std::uint16_t>& copied = camera.rows[rows.band];
    copied.resize(static_cast<std::size_t>(depth.width()));
    for (int y = rows.first; y < rows.last; ++y) {
      const int row = y * camera.step;
      const std::uint16_t* measured = depth.row(row);
      const bool is_inner = row >= reach && row < depth.height() - reach;
      if (remove_flying && is_inner && depth.width() > 2 * reach) {
        std::copy_n(measured, depth.width(), copied.data());
        depth_rows::remove_flying({measured + reach, depth.width() - 2 * reach, camera.unit_m, {}},
                                  pitch, copied.data() + reach);
        measured = copied.data();
      }
      float* const own_m = camera.own_m.row(y);
      read_row(measured, mask.row(row), width, camera.step, camera.unit_m, own_m);
      find_pixels({camera.rays->x(y), camera.rays->y(y), own_m, width}, view, camera.place.row(y),
                  camera.z_m.row(y));
    }
  });
}

/// Calls visit(place, z_m) for each place that a point covers: several where the user is nearer to
/// it than the camera.
template <class Visit>
void MeasuredDepth::for_each_point(const Camera& camera, const Visit& visit) const {
  constexpr float most = 4;
  const Rect& bounds = grid_.intrinsics().bounds();
  for (std::size_t i = 0; i < camera.place.size(); ++i) {
    const std::int32_t place = camera.place.data()[i];
    if (place < 0) continue;
    const float z_m = camera.z_m.data()[i];
    const float across = camera.magnified * camera.own_m.data()[i];
    if (across <= z_m) {
      visit(place, z_m);
      continue;
    }
    const int count = static_cast<int>(std::ceil(std::min(across / z_m, most)));
    const int y = place / bounds.width;
    const Rect covered = intersect(
        {place - y * bounds.width - (count - 1) / 2, y - (count - 1) / 2, count, count}, bounds);
    for (int row = covered.y; row < covered.bottom(); ++row) {
      for (int column = covered.x; column < covered.right(); ++column) {
        visit(row * bounds.width + column, z_m);
      }
    }
  }
}

void MeasuredDepth::draw(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                         const Options& options, Image<float>& depth_m) {
  const int width = grid_.intrinsics().width;
  const int height = grid_.intrinsics().height;
  const auto sees = [&](std::size_t k) {
    return frame.rgbd[k].available() && poses.color_from_depth[k];
  };
  for_tasks(cameras_.size(), [&](std::size_t k) {
    if (!sees(k)) return;
    find_places(frame.rgbd[k], *poses.color_from_depth[k], masks.rgbd_depth[k],
                options.remove_flying, cameras_[k]);
  });
  places_.resize(width, height, {nothing_m, 0, 0});
  for (std::size_t k = 0; k < cameras_.size(); ++k) {
    if (!sees(k)) continue;
    for_each_point(cameras_[k], [&](std::int32_t index, float z_m) {
      Place& place = places_.data()[index];
      const float tolerance_m = between_cameras.at(z_m);
      if (z_m < place.nearest_m - tolerance_m) {
        place = {z_m, z_m, 1};
      } else if (z_m < place.nearest_m + tolerance_m) {
        place.nearest_m = std::min(place.nearest_m, z_m);
        place.sum_m += z_m;
        place.count += 1;
      }
    });
  }
  // With a margin.
  mean_m_.resize(width + 2, height + 2, 0);
  for (int y = 0; y < height; ++y) {
    std::transform(
        places_.row(y), places_.row(y) + width, mean_m_.row(y + 1) + 1,
        [](const Place& place) { return place.count > 0 ? place.sum_m / place.count : 0; });
  }
  depth_m.resize(width, height);
  for (int y = 0; y < height; ++y) {
    close_row(mean_m_.row(y + 1) + 1, mean_m_.row(y) + 1, mean_m_.row(y + 2) + 1, width,
              depth_m.row(y));
  }
}

}  // namespace diminish
