#include "reconstruct/scene_sampler.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/even_color.h"
#include "reconstruct/sdct.h"

namespace diminish {
namespace {

/// Of each camera.
constexpr double wanted_samples = 4000;

/// Further than this from the depth pixels beside it, relative to its own depth, a depth pixel lies
/// on an edge, or on a surface seen edge-on.
constexpr float edge = 0.03F;

constexpr int reach = 2;

bool on_surface(const Image<std::uint16_t>& depth, int column, int row) {
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
    by_camera_.push_back({DepthMesh(camera, rig.color), {}, {}, {}});
  }
}

void SceneSampler::sample(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                          const Rect& region, Reconstruction& reconstruction) {
  oneapi::tbb::parallel_for(std::size_t{0}, by_camera_.size(), [&](std::size_t k) {
    Camera& camera = by_camera_[k];
    camera.samples.clear();
    camera.object_points_m.clear();
    camera.part = {};
    if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) return;
    sample_camera(frame.rgbd[k],
                  {frame.rgbd[k].depth, masks.rgbd_depth[k], masks.rgbd_color[k],
                   FloatTransform(*poses.color_from_depth[k])},
                  region, static_cast<std::uint8_t>(k + 1), camera);
  });
  std::vector<SceneSample>& samples = reconstruction.samples;
  std::vector<Eigen::Vector3f>& points = reconstruction.object_points_m;
  samples.clear();
  points.clear();
  for (const Camera& camera : by_camera_) {
    samples.insert(samples.end(), camera.samples.begin(), camera.samples.end());
    points.insert(points.end(), camera.object_points_m.begin(), camera.object_points_m.end());
  }
}

void SceneSampler::sample_camera(const RgbdFrame& images, const DepthMesh::Frame& frame,
                                 const Rect& region, std::uint8_t source, Camera& camera) const {
  const int width = images.depth.width();
  const int height = images.depth.height();
  const int step = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(width) *
                                                                      height / wanted_samples))));
  constexpr int rim = even_color_reach_px;
  // In the picture: more than a step of samples, and what refinement may move.
  constexpr int margin = 64;
  const Rect around = grow(region, margin);
  for (int row = reach + step / 2; row < height - reach; row += step) {
    for (int column = reach + step / 2; column < width - reach; column += step) {
      if (frame.depth_mask(column, row) != 0 && on_surface(images.depth, column, row)) {
        camera.object_points_m.push_back(camera.mesh.point_m(frame, column, row));
        continue;
      }
      const MeshVertex vertex = camera.mesh.vertex(frame, column, row);
      if (!vertex.valid()) continue;
      SceneSample sample;
      sample.pixel = Eigen::Vector2f(static_cast<float>(vertex.x), static_cast<float>(vertex.y)) /
                     sdct::subpixels;
      if (around.contains(vertex.x / sdct::subpixels, vertex.y / sdct::subpixels)) {
        extend(camera.part, column, row);
      }
      if (!on_surface(images.depth, column, row)) continue;
      const int u = static_cast<int>(std::lrint(vertex.u));
      const int v = static_cast<int>(std::lrint(vertex.v));
      if (u < rim || u >= images.color.width() - rim || v < rim ||
          v >= images.color.height() - rim) {
        continue;
      }
      const EvenColor color = even_color(images.color, u, v);
      const auto level = [&](int c) {
        return static_cast<std::uint8_t>(std::lrint(color.channels[c]));
      };
      sample.point_m = camera.mesh.point_m(frame, column, row);
      sample.texture = {vertex.u, vertex.v};
      sample.color = {level(0), level(1), level(2)};
      sample.source = source;
      sample.even = color.even;
      camera.samples.push_back(sample);
    }
  }
  camera.part = intersect(grow(camera.part, 2 * step), images.depth.bounds());
}

}  // namespace diminish
