#include "depth/visible_blocks.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <random>

#include "analytic_scene.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

constexpr int block_width = VisibleBlocks::width;
constexpr int block_height = VisibleBlocks::height;

/// Where the depth pixels of a frame's first RGB-D camera lie in the picture; nothing where there
/// is no depth or it is behind the camera.
Image<std::optional<Eigen::Vector2d>> project(const Image<std::uint16_t>& depth, const Rig& rig,
                                              const RigidTransform& color_from_depth) {
  const RgbdCamera& camera = rig.rgbd[0];
  const Lens lens(camera.depth);
  const Lens color(rig.color);
  Image<std::optional<Eigen::Vector2d>> places(depth.width(), depth.height());
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      if (depth(x, y) == 0) continue;
      const Eigen::Vector3d ray = lens.undistort({x, y}).homogeneous();
      const Eigen::Vector3d point = ray * (depth(x, y) * camera.depth_unit_m);
      places(x, y) = color.project(color_from_depth * point);
    }
  }
  return places;
}

bool contains(const TiledRegion& region, const std::optional<Eigen::Vector2d>& place) {
  return place && place->x() >= region.x && place->x() < region.right() && place->y() >= region.y &&
         place->y() < region.bottom() &&
         region.keeps(static_cast<int>(place->x()), static_cast<int>(place->y()));
}

/// A block around a pixel.
bool is_visible(const VisibleBlocks& blocks, int x, int y) {
  return blocks.blocks().row(y)[x / block_width] != 0;
}

TEST(VisibleBlocks, HoldWhateverIsSeen) {
  AnalyticScene scene;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  int seen = 0;
  int kept = 0;
  int all = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const AnalyticFrame frame(scene, {{0.7 * unit(random), 0.5 * unit(random), 1.1}},
                              testing::lens_models[trial % 3]);
    Image<std::uint16_t> depth = testing::depths_of(frame.frame)[0];
    for (std::uint16_t& value : depth) value = random() % 9 == 0 ? std::uint16_t{0} : value;
    RigidTransform pose = *frame.poses.color_from_depth[0];
    // Some look past the scene, or away from it.
    const Eigen::Vector3d axis(unit(random), unit(random), unit(random));
    const double angle = trial % 4 == 0 ? 3 * unit(random) : 0.3 * unit(random);
    pose.rotation = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix() * pose.rotation;
    const Rect region{static_cast<int>(random() % 250), static_cast<int>(random() % 200),
                      1 + static_cast<int>(random() % 70), 1 + static_cast<int>(random() % 56)};
    VisibleBlocks blocks(frame.rig.rgbd[0], frame.rig.color);
    blocks.find(depth, pose, region);
    const auto places = project(depth, frame.rig, pose);
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        ++all;
        kept += is_visible(blocks, x, y) ? 1 : 0;
        if (!contains(region, places(x, y))) continue;
        ++seen;
        // A triangle's other corners, too.
        for (const int side : {-1, 0, 1}) {
          const int column = std::clamp(x + side, 0, depth.width() - 1);
          const int row = std::clamp(y + side, 0, depth.height() - 1);
          if (depth(column, row) == 0) continue;
          ASSERT_TRUE(is_visible(blocks, column, row)) << trial << ": " << x << ' ' << y;
        }
      }
    }
  }
  EXPECT_GT(seen, 5000);
  EXPECT_LT(kept, all / 5) << "most is out of view";
}

TEST(VisibleBlocks, HoldWhateverIsSeenInTiles) {
  std::mt19937 random(4);
  int kept = 0;
  int kept_for_all = 0;
  for (int trial = 0; trial < 9; ++trial) {
    const AnalyticFrame frame(AnalyticScene(), {{-0.45, 0.3, 0.9}},
                              testing::lens_models[trial % 3]);
    Image<std::uint16_t> depth = testing::depths_of(frame.frame)[0];
    for (std::uint16_t& value : depth) value = random() % 9 == 0 ? std::uint16_t{0} : value;
    const RigidTransform& pose = *frame.poses.color_from_depth[0];
    const Rect all = frame.rig.color.bounds();
    VisibleBlocks blocks(frame.rig.rgbd[0], frame.rig.color);
    blocks.find(depth, pose, all);
    const BlockSet all_blocks = blocks.blocks();
    TiledRegion region(all);
    region.keep_if([&](const Rect&) { return random() % 40 == 0; });
    blocks.find(depth, pose, region);
    const auto places = project(depth, frame.rig, pose);
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        kept += is_visible(blocks, x, y) ? 1 : 0;
        kept_for_all += all_blocks.row(y)[x / block_width] != 0 ? 1 : 0;
        if (!contains(region, places(x, y))) continue;
        ASSERT_TRUE(is_visible(blocks, x, y)) << trial << ": " << x << ' ' << y;
      }
    }
  }
  EXPECT_GT(kept, 1000);
  EXPECT_LT(kept, kept_for_all * 3 / 4) << "other tiles are out of view";
}

TEST(VisibleBlocks, PartHoldsThemAndABlockAround) {
  const AnalyticFrame frame(AnalyticScene(), {{-0.45, 0.3, 0.9}});
  const Image<std::uint16_t> depth = testing::depths_of(frame.frame)[0];
  VisibleBlocks blocks(frame.rig.rgbd[0], frame.rig.color);
  blocks.find(depth, *frame.poses.color_from_depth[0], Rect{130, 100, 40, 50});
  const Rect image = depth.bounds();
  int visible = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (!is_visible(blocks, x, y)) continue;
      ++visible;
      for (const int dy : {-block_height, 0, block_height}) {
        for (const int dx : {-block_width, 0, block_width}) {
          if (!image.contains(x + dx, y + dy)) continue;
          ASSERT_TRUE(blocks.part().bounds().contains(x + dx, y + dy));
          const DepthPart::Columns& columns = blocks.part().columns(y + dy);
          ASSERT_TRUE(x + dx >= columns.first && x + dx < columns.last) << x << ' ' << y;
        }
      }
    }
  }
  EXPECT_GT(visible, 500);
  const Rect& bounds = blocks.part().bounds();
  EXPECT_EQ(intersect(bounds, image), bounds);
  EXPECT_LT(bounds.width * bounds.height, image.width * image.height / 2);
}

TEST(VisibleBlocks, NoneWithoutDepthOrARegion) {
  const AnalyticFrame frame(AnalyticScene(), {{-0.45, 0.3, 0.9}});
  Image<std::uint16_t> depth = testing::depths_of(frame.frame)[0];
  const RigidTransform& pose = *frame.poses.color_from_depth[0];
  VisibleBlocks blocks(frame.rig.rgbd[0], frame.rig.color);
  blocks.find(depth, pose, frame.rig.color.bounds());
  EXPECT_FALSE(blocks.part().bounds().empty());
  blocks.clear();
  EXPECT_TRUE(blocks.part().bounds().empty());
  depth.fill(0);
  blocks.find(depth, pose, frame.rig.color.bounds());
  EXPECT_TRUE(blocks.part().bounds().empty());
}

}  // namespace
}  // namespace diminish
