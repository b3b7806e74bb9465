#include "detect/shape_detector.h"

namespace diminish {

void OcclusionOutlines::clear(std::size_t cameras, std::size_t objects) {
  rgbd_color.resize(cameras);
  rgbd_depth.resize(cameras);
  color.clear();
  for (Polygons& polygons : rgbd_color) polygons.clear();
  for (Polygons& polygons : rgbd_depth) polygons.clear();
  vertices_m.resize(objects);
  for (auto& vertices : vertices_m) vertices.clear();
}

OccluderReport ShapeDetector::detect(const Observation& observation, OcclusionMasks& masks) {
  outlines_.clear(masks.rgbd_color.size(), 1);
  OccluderReport report;
  report.in_rgbd.assign(masks.rgbd_color.size(), false);
  outline(observation, 0, nullptr, outlines_, report);
  const auto fill = [&](const Polygons& polygons, Mask& mask) {
    std::uint8_t covers = 0;
    filler_.fill(polygons, mask, {&covers, 1});
    return covers != 0;
  };
  report.in_color = fill(outlines_.color, masks.color);
  for (std::size_t k = 0; k < masks.rgbd_color.size(); ++k) {
    const bool in_color = fill(outlines_.rgbd_color[k], masks.rgbd_color[k]);
    const bool in_depth = fill(outlines_.rgbd_depth[k], masks.rgbd_depth[k]);
    report.in_rgbd[k] = in_color || in_depth;
  }
  return report;
}

}  // namespace diminish
