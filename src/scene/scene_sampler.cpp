#include "scene/scene_sampler.h"

#include <algorithm>
#include <cmath>

#include "core/even_color.h"
#include "core/tasks.h"
#include "render/sdct.h"

namespace diminish {
namespace {

/// For each camera.
constexpr double wanted_samples = 4000;

/// A depth pixel that is further than this from its neighbours, relative to its own depth, lies on
/// an edge or on a surface seen edge-on.
constexpr float edge = 0.03F;

constexpr int reach = 2;

/// The distance between samples, in depth pixels.
int step_of(ImageView<std::uint16_t> depth) {
  const double pixels = static_cast<double>(depth.width()) * depth.height();
  return std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / wanted_samples))));
}

bool on_surface(ImageView<std::uint16_t> depth, int column, int row) {
  const auto own = static_cast<float>(depth(column, row));
  for (const auto& [dx, dy] : {std::pair{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}}) {
    const auto other = static_cast<float>(depth(column + dx, row + dy));
    if (!(std::abs(other - own) <= edge * own)) return false;
  }
  return own > 0;
}

}  // namespace

SceneSampler::SceneSampler(const Rig& rig) {
  for (const RgbdCamera& camera : rig.rgbd) {
    by_camera_.push_back({DepthMesh(camera, rig.color), {}});
  }
}

void SceneSampler::sample(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                          SceneSamples& samples) {
  for_tasks(by_camera_.size(), [&](std::size_t k) {
    Camera& camera = by_camera_[k];
    for (Band& band : camera.bands) {
      band.samples.clear();
      band.object_points_m.clear();
    }
    const RgbdFrame& rgbd = frame.rgbd[k];
    if (!rgbd.available() || !poses.color_from_depth[k]) return;
    const View view{rgbd,
                    camera.mesh,
                    {rgbd.depth, masks.rgbd_depth[k], masks.rgbd_color[k],
                     FloatTransform(*poses.color_from_depth[k])},
                    static_cast<std::uint8_t>(k + 1)};
    for_rows(rgbd.depth.height(),
             [&](Rows rows) { sample_rows(view, rows, camera.bands[rows.band]); });
  });
  std::vector<SceneSample>& surfaces = samples.surfaces;
  std::vector<Eigen::Vector3f>& points = samples.object_points_m;
  surfaces.clear();
  points.clear();
  for (const Camera& camera : by_camera_) {
    for (const Band& band : camera.bands) {
      surfaces.insert(surfaces.end(), band.samples.begin(), band.samples.end());
      points.insert(points.end(), band.object_points_m.begin(), band.object_points_m.end());
    }
  }
}

void SceneSampler::sample_rows(const View& view, Rows rows, Band& band) {
  const ImageView<std::uint16_t> depth = view.images.depth;
  const ImageView<Bgr> image = view.images.color;
  const int step = step_of(depth);
  constexpr int rim = even_color_reach_px;
  for (int row = reach + step / 2; row < std::min(depth.height() - reach, rows.last); row += step) {
    if (row < rows.first) continue;
    for (int column = reach + step / 2; column < depth.width() - reach; column += step) {
      if (!on_surface(depth, column, row)) continue;
      if (view.frame.depth_mask(column, row) != 0) {
        band.object_points_m.push_back(view.mesh.point_m(view.frame, column, row));
        continue;
      }
      const MeshVertex vertex = view.mesh.vertex(view.frame, column, row);
      if (!vertex.valid()) continue;
      SceneSample sample;
      sample.pixel = Eigen::Vector2f(static_cast<float>(vertex.x), static_cast<float>(vertex.y)) /
                     sdct::subpixels;
      const int u = static_cast<int>(std::lrint(vertex.u));
      const int v = static_cast<int>(std::lrint(vertex.v));
      if (u < rim || u >= image.width() - rim || v < rim || v >= image.height() - rim) {
        continue;
      }
      const EvenColor color = even_color(image, u, v);
      const auto level = [&](int c) {
        return static_cast<std::uint8_t>(std::lrint(color.channels[c]));
      };
      sample.point_m = view.mesh.point_m(view.frame, column, row);
      sample.texture = {vertex.u, vertex.v};
      sample.color = {level(0), level(1), level(2)};
      sample.source = view.source;
      sample.even = color.even;
      band.samples.push_back(sample);
    }
  }
}

}  // namespace diminish
