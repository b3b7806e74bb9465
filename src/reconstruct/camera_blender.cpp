#include "reconstruct/camera_blender.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/rows.h"
#include "reconstruct/depth_noise.h"
#include "reconstruct/layers.h"

namespace diminish {

void CameraBlender::begin(std::vector<Surface>& surfaces, const Rect& region,
                          const Intrinsics& color, float agreement_m) {
  surfaces_ = &surfaces;
  region_ = region;
  color_ = color;
  agreement_m_ = agreement_m;
  for_rows(region.height, [&](Rows rows) {
    const int thread = rows.first == 0 ? 0 : 1;
    slivers_[thread].clear();
    for (int y = rows.first; y < rows.last; ++y) {
      find_slivers(y, scratch_[thread], slivers_[thread]);
    }
  });
  for (const std::vector<Sliver>& slivers : slivers_) {
    for (const Sliver& sliver : slivers) {
      SurfaceBuffer& buffer = *surfaces[sliver.camera].rows[static_cast<std::size_t>(sliver.y)];
      buffer.inverse_z[static_cast<std::size_t>(buffer.row(region.y + sliver.y) + sliver.x)] = 0;
    }
  }
  grid_.begin(region, color, surfaces.size());
  for_rows(region.height, [&](Rows rows) {
    constexpr int cell_px = ConfidenceGrid::cell_px;
    const int last = rows.last == region.height ? grid_.rows() : rows.last / cell_px;
    for (int row = rows.first / cell_px; row < last; ++row) {
      measure_cells(row, scratch_[rows.first == 0 ? 0 : 1]);
    }
  });
  oneapi::tbb::parallel_for(std::size_t{0}, surfaces.size(),
                            [&](std::size_t k) { grid_.finish(k, surfaces[k].place); });
}

/// y: relative to the region's corner, as everywhere below.
void CameraBlender::gather(int y, std::vector<BlendedRow>& rows) const {
  rows.clear();
  const Eigen::Vector3f ray =
      pinhole_ray(color_, static_cast<float>(region_.x), static_cast<float>(region_.y + y));
  for (const Surface& surface : *surfaces_) {
    BlendedRow row(*surface.rows[static_cast<std::size_t>(y)], region_.y + y, surface.source);
    const Eigen::Vector3f& forward = surface.place.forward;
    row.depth_slope = forward.dot(ray);
    row.depth_step = forward.x() / static_cast<float>(color_.fx);
    row.depth_offset_m = forward.dot(surface.place.eye_m);
    rows.push_back(row);
  }
}

void CameraBlender::find_slivers(int y, Scratch& scratch, std::vector<Sliver>& slivers) const {
  gather(y, scratch.rows);
  scratch.bytes.resize(static_cast<std::size_t>(region_.width));
  find_lone(scratch.rows, agreement_m_, region_.width, scratch.bytes.data());
  const std::uint8_t* const begin = scratch.bytes.data();
  const std::uint8_t* const end = begin + region_.width;
  for (const std::uint8_t* lone = std::find(begin, end, 255); lone != end;
       lone = std::find(lone + 1, end, 255)) {
    const auto x = static_cast<int>(lone - begin);
    const auto nearest = std::max_element(
        scratch.rows.begin(), scratch.rows.end(),
        [&](const BlendedRow& a, const BlendedRow& b) { return a.inverse_z[x] < b.inverse_z[x]; });
    const float depth_m = (nearest->depth_slope + nearest->depth_step * static_cast<float>(x)) /
                              nearest->inverse_z[x] -
                          nearest->depth_offset_m;
    const float noise_m = DepthNoise().at(depth_m);
    const auto camera = static_cast<std::size_t>(nearest - scratch.rows.begin());
    if (is_sliver((*surfaces_)[camera], x, y,
                  agreement_tolerance_m(agreement_m_, noise_m, noise_m))) {
      slivers.push_back({camera, x, y});
    }
  }
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

void CameraBlender::measure_cells(int cell_row, Scratch& scratch) {
  const auto width = static_cast<std::size_t>(region_.width);
  const std::size_t cameras = surfaces_->size();
  scratch.bytes.assign(cameras * width, 255);
  scratch.covered.resize(cameras);
  for (std::size_t k = 0; k < cameras; ++k) scratch.covered[k] = scratch.bytes.data() + k * width;
  const Rect first = grid_.cell(0, cell_row);
  for (int y = first.y; y < first.bottom(); y += ConfidenceGrid::row_step) {
    gather(y, scratch.rows);
    mark_uncovered(scratch.rows, agreement_m_, region_.width, scratch.covered);
  }
  const auto place = [](const SurfaceRow& row, int x) {
    const float z = 1 / row.inverse_z[x];
    return Eigen::Vector2f(row.u_over_z[x] * z, row.v_over_z[x] * z);
  };
  const int bottom = ConfidenceGrid::last_row(first);
  for (std::size_t k = 0; k < cameras; ++k) {
    const Surface& surface = (*surfaces_)[k];
    const auto row_at = [&](int y) {
      return SurfaceRow(*surface.rows[static_cast<std::size_t>(y)], region_.y + y, surface.source);
    };
    const SurfaceRow upper = row_at(first.y);
    const SurfaceRow lower = row_at(bottom);
    for (int column = 0; column < grid_.columns(); ++column) {
      const Rect cell = grid_.cell(column, cell_row);
      const std::uint8_t* const covered = scratch.covered[k] + cell.x;
      if (std::memchr(covered, 0, static_cast<std::size_t>(cell.width))) {
        grid_.set(k, column, cell_row, 0, 0);
        continue;
      }
      const int right = cell.right() - 1;
      const Eigen::Vector2f origin = place(upper, cell.x);
      const Eigen::Vector2f along_x = place(upper, right) - origin;
      const Eigen::Vector2f along_y = place(lower, cell.x) - origin;
      const float area = along_x.x() * along_y.y() - along_x.y() * along_y.x();
      const int pixels = std::max(1, right - cell.x) * std::max(1, bottom - cell.y);
      grid_.set(k, column, cell_row,
                std::max(area / static_cast<float>(pixels), ConfidenceGrid::least_resolution),
                1 / upper.inverse_z[cell.x]);
    }
  }
}

const std::vector<BlendedRow>& CameraBlender::choose(int y, const TwoSources& out,
                                                     Scratch& scratch) const {
  const int row = y - region_.y;
  gather(row, scratch.rows);
  const auto width = static_cast<std::size_t>(region_.width);
  scratch.confidences.resize(scratch.rows.size() * width);
  for (std::size_t k = 0; k < scratch.rows.size(); ++k) {
    float* const confidence = scratch.confidences.data() + k * width;
    grid_.row(k, row, scratch.nodes, confidence);
    scratch.rows[k].confidence = confidence;
  }
  choose_two(scratch.rows, agreement_m_, region_.width, out);
  return scratch.rows;
}

}  // namespace diminish
