#include "scene/scene_sampler.h"

#include "core/tasks.h"
#include "diminish/remote_images.h"
#include "render/sdct.h"
#include "scene/sample_grid.h"

namespace diminish {

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
    if (!rgbd.takes_part() || !poses.color_from_depth[k]) return;
    const View view{rgbd,
                    camera.mesh,
                    {rgbd.depth, masks.rgbd_depth[k], masks.rgbd_color[k],
                     FloatTransform(*poses.color_from_depth[k])},
                    static_cast<std::uint8_t>(k + 1)};
    if (rgbd.is_remote()) return take_points(view, rgbd.remote->glance(), camera.bands[0]);
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
  const SampleGrid grid(depth.width(), depth.height());
  for (int i = grid.row_from(rows.first); i < grid.rows() && grid.row(i) < rows.last; ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const int column = grid.column(j);
      const int row = grid.row(i);
      if (!is_on_surface(depth, column, row)) continue;
      take(view, column, row, band, [&](SceneSample& sample) {
        SampleColor found;
        if (!find_sample_color(view.images.color, sample.texture.x(), sample.texture.y(), found)) {
          return false;
        }
        sample.color = found.color;
        sample.even = found.even;
        return true;
      });
    }
  }
}

void SceneSampler::take_points(const View& view, const Glance& glance, Band& band) {
  for (std::size_t i = 0; i < glance.points.size(); ++i) {
    const GlancePoint& point = glance.points[i];
    take(view, point.column, point.row, band, [&](SceneSample& sample) {
      if (!point.has_color) return false;
      sample.color = point.color;
      sample.even = point.even;
      sample.point = static_cast<std::uint32_t>(i);
      return true;
    });
  }
}

/// A pixel on a surface: of an object, or a sample if it has a colour.
template <class FindColor>
void SceneSampler::take(const View& view, int column, int row, Band& band,
                        const FindColor& find_color) {
  if (view.frame.depth_mask(column, row) != 0) {
    band.object_points_m.push_back(view.mesh.point_m(view.frame, column, row));
    return;
  }
  const MeshVertex vertex = view.mesh.vertex(view.frame, column, row);
  if (!vertex.valid()) return;
  SceneSample sample;
  sample.pixel =
      Eigen::Vector2f(static_cast<float>(vertex.x), static_cast<float>(vertex.y)) / sdct::subpixels;
  sample.texture = {vertex.u, vertex.v};
  if (!find_color(sample)) return;
  sample.point_m = view.mesh.point_m(view.frame, column, row);
  sample.source = view.source;
  band.samples.push_back(sample);
}

}  // namespace diminish
