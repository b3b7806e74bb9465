#include "depth/edge_snapping.h"

#include <gtest/gtest.h>

#include "analytic_scene.h"

namespace diminish {
namespace {

using testing::AnalyticFrame;
using testing::AnalyticScene;

/// A box in front of a wall, both of one colour. Its depth image has a rim without depth around it,
/// as flying pixels leave it.
class SpoiltEdges : public ::testing::Test {
 protected:
  SpoiltEdges() : exact_(frame_.frame.rgbd[0].depth.own()), with_rim_(exact_) {
    const RigidTransform depth_from_world = *frame_.poses.depth_from_world[0];
    const RigidTransform color_from_world = camera_.color_from_depth * depth_from_world;
    const Eigen::Vector3d color_eye = color_from_world.inverse().translation;
    on_box_.resize(exact_.width(), exact_.height());
    is_seen_.resize(exact_.width(), exact_.height());
    scene_.render(Lens(camera_.depth), depth_from_world,
                  [&](int x, int y, const AnalyticScene::Hit& hit) {
                    on_box_(x, y) = hit.on_box ? 1 : 0;
                    const auto first = scene_.cast(color_eye, hit.point - color_eye);
                    is_seen_(x, y) = (first.point - hit.point).norm() < 1e-6 ? 1 : 0;
                  });
    scene_.render(Lens(camera_.color), color_from_world,
                  [&](int x, int y, const AnalyticScene::Hit& hit) {
                    const auto shade = static_cast<std::uint8_t>(x % 7 + y % 5);
                    frame_.frame.rgbd[0].color.own()(x, y) =
                        hit.on_box ? Bgr{40, 60, static_cast<std::uint8_t>(150 + shade)}
                                   : Bgr{90, static_cast<std::uint8_t>(100 + shade), 110};
                  });
    for (int y = 4; y < exact_.height() - 4; ++y) {
      for (int x = 4; x < exact_.width() - 4; ++x) {
        if (on_box_(x, y) != 0) continue;
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            if (on_box_(x + dx, y + dy) != 0) with_rim_(x, y) = 0;
          }
        }
      }
    }
  }

  Image<std::uint16_t> snapped(Image<std::uint16_t> depth, const OcclusionMasks& masks) const {
    const EdgeSnapping::Images images{frame_.frame.rgbd[0].color, masks.rgbd_color[0],
                                      masks.rgbd_depth[0]};
    EdgeSnapping(camera_).snap(images, camera_.depth.bounds(), depth);
    return depth;
  }

  /// The number of pixels visible to the colour sensor whose depth is off by more than 2 cm.
  int count_wrong(const Image<std::uint16_t>& depth) const {
    int wrong = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const int off = std::abs(depth.data()[i] - exact_.data()[i]);
      wrong += is_seen_.data()[i] != 0 && off * camera_.depth_unit_m > 0.02 ? 1 : 0;
    }
    return wrong;
  }

  AnalyticScene scene_;
  AnalyticFrame frame_{scene_, {Eigen::Vector3d(-0.2, 0.1, 1.0)}};
  const RgbdCamera& camera_ = frame_.rig.rgbd[0];
  const OcclusionMasks no_masks_ = testing::empty_masks(frame_.rig);
  Image<std::uint16_t> exact_, with_rim_;
  Image<std::uint8_t> on_box_, is_seen_;
};

TEST_F(SpoiltEdges, BecomeThoseOfTheColorImage) {
  const int before = count_wrong(with_rim_);
  ASSERT_GT(before, 150);
  EXPECT_LT(count_wrong(snapped(with_rim_, no_masks_)), before / 5);
}

TEST_F(SpoiltEdges, RightEdgesStayRight) {
  EXPECT_LT(count_wrong(snapped(exact_, no_masks_)), 20);
}

TEST_F(SpoiltEdges, StayWhereTheColorsAreAlike) {
  frame_.frame.rgbd[0].color.own().fill(camera_.color.bounds(), {90, 120, 100});
  EXPECT_EQ(snapped(with_rim_, no_masks_), with_rim_);
}

TEST_F(SpoiltEdges, OfWhatIsMaskedAreLeftAlone) {
  OcclusionMasks masks = no_masks_;
  masks.rgbd_color[0].fill(255);
  EXPECT_EQ(snapped(with_rim_, masks), with_rim_) << "its colours are not known";
  // The box is masked: only the wall is left, and one surface has no edge.
  masks = no_masks_;
  for (std::size_t i = 0; i < on_box_.size(); ++i) {
    masks.rgbd_depth[0].data()[i] = on_box_.data()[i] != 0 ? 255 : 0;
  }
  EXPECT_EQ(snapped(with_rim_, masks), with_rim_);
}

TEST_F(SpoiltEdges, OnlyInThePart) {
  Image<std::uint16_t> depth = with_rim_;
  const Rect part{100, 60, 40, 50};
  EdgeSnapping snapping(camera_);
  snapping.snap({frame_.frame.rgbd[0].color, no_masks_.rgbd_color[0], no_masks_.rgbd_depth[0]},
                part, depth);
  const Image<std::uint16_t> everywhere = snapped(with_rim_, no_masks_);
  int changed = 0;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      // At the part's border neighbours are missing.
      if (part.contains(x, y) && !grow(part, -4).contains(x, y)) continue;
      const auto& expected = part.contains(x, y) ? everywhere : with_rim_;
      ASSERT_EQ(depth(x, y), expected(x, y));
      changed += depth(x, y) != with_rim_(x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(changed, 0);
}

}  // namespace
}  // namespace diminish
