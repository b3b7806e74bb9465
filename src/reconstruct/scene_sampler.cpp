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
    by_camera_.push_back({DepthMesh(camera, rig.color), {}, {}});
  }
}

void SceneSampler::sample(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                          const Rect& region, std::vector<SceneSample>& samples) {
  oneapi::tbb::parallel_for(std::size_t{0}, by_camera_.size(), [&](std::size_t k) {
    Camera& camera = by_camera_[k];
    camera.samples.clear();
    camera.part = {};
    if (!frame.rgbd[k].available() || !poses.color_from_depth[k]) return;
    sample_camera(frame.rgbd[k],
                  {frame.rgbd[k].depth, masks.rgbd_depth[k], masks.rgbd_color[k],
                   FloatTransform(*poses.color_from_depth[k])},
                  region, static_cast<std::uint8_t>(k + 1), camera);
  });
  samples.clear();
  for (const Camera& camera : by_camera_) {
    samples.insert(samples.end(), camera.samples.begin(), camera.samples.end());
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
      const Eigen::Vector2f& ray = camera.mesh.ray(column, row);
      const float x = ray.x() * vertex.depth_m;
      const float y = ray.y() * vertex.depth_m;
      sample.point_m = {frame.to_color.apply(0, x, y, vertex.depth_m),
                        frame.to_color.apply(1, x, y, vertex.depth_m),
                        frame.to_color.apply(2, x, y, vertex.depth_m)};
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
