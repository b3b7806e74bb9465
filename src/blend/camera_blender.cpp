#include "blend/camera_blender.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>

#include "blend/cell_resolution.h"
#include "blend/layers.h"
#include "core/rows.h"
#include "core/runs.h"
#include "core/tasks.h"
#include "depth/depth_noise.h"

namespace diminish {
namespace {

/// In the RGB-D camera's frame.
float depth_m(const BlendedRow& row, int x) {
  return (row.depth_slope + row.depth_step * static_cast<float>(x)) / row.inverse_z[x] -
         row.depth_offset_m;
}

}  // namespace

void CameraBlender::begin(std::vector<Surface>& surfaces, const TiledRegion& region,
                          const Intrinsics& color, float agreement_m) {
  surfaces_ = &surfaces;
  region_ = region;
  color_ = color;
  agreement_m_ = agreement_m;
  seen_.resize(region.width, region.height);
  for (std::vector<Sliver>& slivers : slivers_) slivers.clear();
  for_rows(region.height, [&](Rows rows) {
    std::vector<Sliver>& slivers = slivers_[rows.band];
    for (int y = rows.first; y < rows.last; ++y) look_at_row(y, scratch_[rows.band], slivers);
  });
  for (const std::vector<Sliver>& slivers : slivers_) {
    for (const Sliver& sliver : slivers) remove(sliver);
  }
  grid_.begin(region, color, surfaces.size());
  for_rows(region.height, [&](Rows rows) {
    constexpr int cell_px = ConfidenceGrid::cell_px;
    const int last = rows.last == region.height ? grid_.rows() : rows.last / cell_px;
    for (int row = rows.first / cell_px; row < last; ++row) {
      measure_cells(row, scratch_[rows.band]);
    }
  });
  for_tasks(surfaces.size(), [&](std::size_t k) { grid_.finish(k, surfaces[k].place); });
}

/// Calls visit(first, last) for the runs of a row's pixels that belong to the region. Places are
/// relative to its corner, here and below.
template <class Visit>
void CameraBlender::for_each_run(int y, const Visit& visit) const {
  region_.for_each_run(region_.y + y,
                       [&](int first, int last) { visit(first - region_.x, last - region_.x); });
}

/// Rows from pixel (x, y) on.
void CameraBlender::gather(int x, int y, std::vector<BlendedRow>& rows) const {
  rows.clear();
  const Eigen::Vector3f ray =
      pinhole_ray(color_, static_cast<float>(region_.x + x), static_cast<float>(region_.y + y));
  for (const Surface& surface : *surfaces_) {
    BlendedRow row(
        SurfaceRow(*surface.rows[static_cast<std::size_t>(y)], region_.y + y, surface.source)
            .from(x));
    const Eigen::Vector3f& forward = surface.place.forward;
    row.depth_slope = forward.dot(ray);
    row.depth_step = forward.x() / static_cast<float>(color_.fx);
    row.depth_offset_m = forward.dot(surface.place.eye_m);
    rows.push_back(row);
  }
}

void CameraBlender::look_at_row(int y, Scratch& scratch, std::vector<Sliver>& slivers) {
  scratch.bytes.resize(static_cast<std::size_t>(region_.width));
  std::uint8_t* const lone = scratch.bytes.data();
  std::fill_n(seen_.row(y), region_.width, std::uint8_t{0});
  for_each_run(y, [&](int first, int last) {
    gather(first, y, scratch.rows);
    find_seen(scratch.rows, agreement_m_, last - first, seen_.row(y) + first, lone + first);
    for (int x = first; (x = find_equal(lone, x, last, 255)) < last; ++x) {
      const auto camera = static_cast<std::size_t>(std::countr_zero(seen_(x, y)));
      const float noise_m = DepthNoise().at(depth_m(scratch.rows[camera], x - first));
      if (is_sliver((*surfaces_)[camera], x, y,
                    agreement_tolerance_m(agreement_m_, noise_m, noise_m))) {
        slivers.push_back({camera, x, y});
      }
    }
  });
}

bool CameraBlender::is_sliver(const Surface& surface, int x, int y, float tolerance_m) const {
  const auto row_of = [&](int row) {
    const SurfaceBuffer& buffer = *surface.rows[static_cast<std::size_t>(row)];
    return buffer.inverse_z.data() + buffer.row(region_.y + row);
  };
  const float z = 1 / row_of(y)[x];
  const float least = 1 / (z + tolerance_m);
  const float most = z > tolerance_m ? 1 / (z - tolerance_m) : INFINITY;
  constexpr int reach = blending::window_reach;
  const int left = std::max(0, x - reach);
  const int right = std::min(region_.width - 1, x + reach);
  const int top = std::max(0, y - reach);
  const int bottom = std::min(region_.height - 1, y + reach);
  const float enough =
      blending::least_part * static_cast<float>((right - left + 1) * (bottom - top + 1));
  int same = 0;
  for (int v = top; v <= bottom; ++v) {
    const float* const inverse_z = row_of(v);
    for (int u = left; u <= right; ++u) {
      same += inverse_z[u] > least && inverse_z[u] < most ? 1 : 0;
    }
    if (static_cast<float>(same) >= enough) return false;
  }
  return true;
}

/// Now the surface behind it is seen.
void CameraBlender::remove(const Sliver& sliver) {
  SurfaceBuffer& buffer = *(*surfaces_)[sliver.camera].rows[static_cast<std::size_t>(sliver.y)];
  buffer.inverse_z[static_cast<std::size_t>(buffer.row(region_.y + sliver.y) + sliver.x)] = 0;
  std::vector<BlendedRow>& rows = scratch_[0].rows;
  gather(sliver.x, sliver.y, rows);
  std::uint8_t lone = 0;
  find_seen(rows, agreement_m_, 1, &seen_(sliver.x, sliver.y), &lone);
}

void CameraBlender::measure_cells(int cell_row, Scratch& scratch) {
  const Rect first = grid_.cell(0, cell_row);
  // The cameras that see the nearest surface in all rows of a column.
  scratch.bytes.assign(static_cast<std::size_t>(region_.width), 255);
  std::uint8_t* const seen_by = scratch.bytes.data();
  for (int y = first.y; y < first.bottom(); ++y) {
    const std::uint8_t* const seen = seen_.row(y);
    // A local copy: a stored byte could alias the member.
    const int width = region_.width;
    for (int x = 0; x < width; ++x) seen_by[x] &= seen[x];
  }
  const int bottom = first.bottom() - 1;
  for (std::size_t k = 0; k < surfaces_->size(); ++k) {
    const Surface& surface = (*surfaces_)[k];
    const auto row_at = [&](int y) {
      return SurfaceRow(*surface.rows[static_cast<std::size_t>(y)], region_.y + y, surface.source);
    };
    const SurfaceRow upper = row_at(first.y);
    const SurfaceRow lower = row_at(bottom);
    for (int column = 0; column < grid_.columns(); ++column) {
      const Rect cell = grid_.cell(column, cell_row);
      const auto seen = scratch.bytes.begin() + cell.x;
      const std::uint8_t covering =
          std::accumulate(seen, seen + cell.width, std::uint8_t{255}, std::bit_and<>());
      if ((covering >> k & 1) == 0) {
        grid_.set(k, column, cell_row, 0, 0);
        continue;
      }
      const float resolution = surface.resolution ? (*surface.resolution)(column, cell_row)
                                                  : cell_resolution(upper, lower, cell);
      grid_.set(k, column, cell_row, resolution, 1 / upper.inverse_z[cell.x]);
    }
  }
}

const std::vector<BlendedRow>& CameraBlender::choose(int y, const TwoSources& out,
                                                     Scratch& scratch) const {
  const int row = y - region_.y;
  const auto width = static_cast<std::size_t>(region_.width);
  scratch.confidences.resize(surfaces_->size() * width);
  for (std::size_t k = 0; k < surfaces_->size(); ++k) {
    grid_.row(k, row, scratch.nodes, scratch.confidences.data() + k * width);
  }
  out.clear(region_.width);
  for_each_run(row, [&](int first, int last) {
    gather(first, row, scratch.rows);
    for (std::size_t k = 0; k < scratch.rows.size(); ++k) {
      scratch.rows[k].confidence = scratch.confidences.data() + k * width + first;
    }
    choose_two(scratch.rows, last - first, seen_.row(row) + first, out.from(first));
  });
  gather(0, row, scratch.rows);
  return scratch.rows;
}

}  // namespace diminish
