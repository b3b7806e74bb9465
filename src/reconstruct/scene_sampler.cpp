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

bool on_surface(const Image<std::uint16_t>& depth, int column, int row) {
  const auto own = static_cast<float>(depth(column, row));
  constexpr int reach = 2;
  for (const auto& [dx, dy] : {std::pair{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}}) {
    const auto other = static_cast<float>(depth(column + dx, row + dy));
    if (!(std::abs(other - own) <= edge * own)) return false;
  }
  return own > 0;
}

}  // namespace

SceneSampler::SceneSampler(const Rig& rig) : color_(rig.color), by_camera_(rig.rgbd.size()) {
  for (const RgbdCamera& camera : rig.rgbd) meshes_.emplace_back(camera, rig.color);
}

void SceneSampler::sample(const FrameSet& frame, const DepthImages& depths, const Poses& poses, const OcclusionMasks& masks,
                          std::vector<SceneSample>& samples) {
  oneapi::tbb::parallel_for(std::size_t{0}, meshes_.size(), [&](std::size_t k) {
    by_camera_[k].clear();
    if (frame.rgbd[k].available() && poses.color_from_depth[k]) {
      sample_camera(frame, depths, poses, masks, k, by_camera_[k]);
    }
  });
  samples.clear();
  for (const auto& part : by_camera_) samples.insert(samples.end(), part.begin(), part.end());
}

void SceneSampler::sample_camera(const FrameSet& frame, const DepthImages& depths, const Poses& poses,
                                 const OcclusionMasks& masks, std::size_t k,
                                 std::vector<SceneSample>& samples) const {
  const RgbdFrame& images = frame.rgbd[k];
  const DepthMesh::Frame mesh_frame{depths[k], masks.rgbd_depth[k], masks.rgbd_color[k],
                                    FloatTransform(*poses.color_from_depth[k])};
  const int width = depths[k].width();
  const int height = depths[k].height();
  const int step = std::max(
      1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(width) * height / wanted_samples))));
  constexpr int rim = even_color_reach_px;
  for (int row = 2 + step / 2; row < height - 2; row += step) {
    for (int column = 2 + step / 2; column < width - 2; column += step) {
      if (!on_surface(depths[k], column, row)) continue;
      const MeshVertex vertex = meshes_[k].vertex(mesh_frame, column, row);
      if (!vertex.valid()) continue;
      const Eigen::Vector2f pixel = Eigen::Vector2f(static_cast<float>(vertex.x), static_cast<float>(vertex.y)) / sdct::subpixels;
      const int u = static_cast<int>(std::lrint(vertex.u));
      const int v = static_cast<int>(std::lrint(vertex.v));
      if (u < rim || u >= images.color.width() - rim || v < rim ||
          v >= images.color.height() - rim) {
        continue;
      }
      const EvenColor color = even_color(images.color, u, v);
      const Eigen::Vector2f& ray = meshes_[k].ray(column, row);
      const float x = ray.x() * vertex.depth_m;
      const float y = ray.y() * vertex.depth_m;
      SceneSample sample;
      for (int axis = 0; axis < 3; ++axis) {
        sample.point_m[axis] = mesh_frame.to_color.apply(axis, x, y, vertex.depth_m);
      }
      sample.pixel = pixel;
      sample.texture = {vertex.u, vertex.v};
      const auto level = [&](int c) { return static_cast<std::uint8_t>(std::lrint(color.channels[c])); };
      sample.color = {level(0), level(1), level(2)};
      sample.source = static_cast<std::uint8_t>(k + 1);
      sample.even = color.even;
      samples.push_back(sample);
    }
  }
}

}  // namespace diminish
