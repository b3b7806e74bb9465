#include "render/vertex_row.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <random>

#include "analytic_scene.h"
#include "render/depth_mesh.h"

namespace diminish {
namespace {

void expect_the_plain_versions_vertices() {
  for (const LensModel model : testing::lens_models) {
    SCOPED_TRACE(name_of(model));
    const testing::AnalyticFrame scene({}, {Eigen::Vector3d(-0.45, 0.3, 0.9)}, model);
    const RgbdCamera& camera = scene.rig.rgbd[0];
    OcclusionMasks masks = testing::empty_masks(scene.rig);
    masks.rgbd_depth[0].fill({30, 40, 37, 21}, 255);
    masks.rgbd_color[0].fill({200, 90, 61, 50}, 255);
    Image<std::uint16_t> depth = testing::depths_of(scene.frame)[0];
    std::mt19937 random(4);
    for (int i = 0; i < 400; ++i) {  // thin gaps and holes, some at the rim
      const int x = static_cast<int>(random() % static_cast<unsigned>(depth.width()));
      const int y = static_cast<int>(random() % static_cast<unsigned>(depth.height()));
      const Rect hole{x, y, 1 + static_cast<int>(random() % 4), 1 + static_cast<int>(random() % 4)};
      depth.fill(intersect(hole, depth.bounds()), 0);
    }
    const FloatTransform to_color(*scene.poses.color_from_depth[0]);

    Image<MeshVertex> expected;
    DepthMesh(camera, scene.rig.color)
        .compute({depth, masks.rgbd_depth[0], masks.rgbd_color[0], to_color}, expected);

    const Rect region = scene.rig.color.bounds();
    VisibleBlocks visible(camera, scene.rig.color);
    visible.find(depth, *scene.poses.color_from_depth[0], region);
    const VertexRows rows(camera, scene.rig.color);
    // All but the first block of a row.
    const int first = VertexRow::block;
    const VertexRows::Frame frame{
        depth, masks.rgbd_depth[0],           masks.rgbd_color[0], to_color, visible.blocks(),
        1,     visible.blocks().columns() - 1};
    VertexRow row;
    row.resize(depth.width() - first);
    int vertices = 0;
    for (int y = 0; y < depth.height(); ++y) {
      rows.project(frame, y, row);
      for (int x = first; x < depth.width(); ++x) {
        if (visible.blocks().row(y)[x / VertexRow::block] == 0) continue;
        const auto i = static_cast<std::size_t>(x - first);
        const MeshVertex& vertex = expected(x, y);
        ASSERT_EQ(row.inverse_z[i], vertex.inverse_z) << x << ' ' << y;
        if (vertex.inverse_z == 0) continue;
        ++vertices;
        ASSERT_EQ(row.x[i], vertex.x) << x << ' ' << y;
        ASSERT_EQ(row.y[i], vertex.y) << x << ' ' << y;
        ASSERT_EQ(row.depth_m[i], vertex.depth_m) << x << ' ' << y;
        ASSERT_EQ(row.u_over_z[i], vertex.u * vertex.inverse_z) << x << ' ' << y;
        ASSERT_EQ(row.v_over_z[i], vertex.v * vertex.inverse_z) << x << ' ' << y;
      }
    }
    EXPECT_GT(vertices, 20000);
  }
}

// Through every lens, on every instruction set, to the bit.
TEST(VertexRows, AreTheVerticesOfThePlainVersion) {
  int targets = 0;
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
    const std::int64_t target = rest & -rest;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    expect_the_plain_versions_vertices();
    hwy::SetSupportedTargetsForTest(0);
    ++targets;
  }
  EXPECT_GE(targets, 1);
}

}  // namespace
}  // namespace diminish
