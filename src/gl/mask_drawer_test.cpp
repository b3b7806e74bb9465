#include "gl/mask_drawer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "detect/occlusion_masks.h"
#include "detection.h"
#include "first_frame.h"
#include "paths.h"

namespace diminish {
namespace {

class MasksOfRecordings : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, MasksOfRecordings,
                         ::testing::Values("calendar", "ball", "workbench"),
                         [](const auto& test) { return std::string(test.param); });

// Hulls, meshes, and what a detector has set itself; usual margins, none, and one that is too wide
// for the GPU.
TEST_P(MasksOfRecordings, AreTheCpusOnTheGpu) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / GetParam());
  Pipeline pipeline(recording.rig, recording.scene, {});
  OccluderStage by_cpu(recording.rig, recording.scene);
  OccluderStage by_gpu(recording.rig, recording.scene);
  by_gpu.draw_by("gl");
  const auto source = open_recording(recording, {});
  FrameSet frame;
  DiminishedFrame result;
  const OcclusionMasks& expected = by_cpu.masks();
  const OcclusionMasks& masks = by_gpu.masks();
  std::vector<OccluderReport> expected_reports;
  std::vector<OccluderReport> reports;
  while (source->next(frame)) {
    pipeline.process(frame, result);
    for (const int margin_px : {5, 0, 31, 40}) {
      SCOPED_TRACE(frame.name + ", " + std::to_string(margin_px));
      Options options;
      options.mask_margin_px = options.rgbd_mask_margin_px = margin_px;
      const Observation observation{frame, result.report.markers, result.report.poses, options};
      by_cpu.detect(observation, expected_reports);
      by_gpu.detect(observation, reports);
      ASSERT_EQ(by_gpu.message(), "");
      EXPECT_GT(count_nonzero(expected.color, expected.color.bounds()), 1000U);
      // The RGB-D camera does not see the ball.
      EXPECT_EQ(any_set(expected.rgbd_color[0]) && any_set(expected.rgbd_depth[0]),
                std::string(GetParam()) != "ball");
      EXPECT_EQ(masks.color, expected.color);
      EXPECT_EQ(masks.rgbd_color, expected.rgbd_color);
      EXPECT_EQ(masks.rgbd_depth, expected.rgbd_depth);
      ASSERT_EQ(reports.size(), expected_reports.size());
      for (std::size_t i = 0; i < reports.size(); ++i) {
        EXPECT_TRUE(reports[i].in_color);
        EXPECT_EQ(reports[i].in_color, expected_reports[i].in_color);
        EXPECT_EQ(reports[i].in_rgbd, expected_reports[i].in_rgbd);
      }
    }
  }
}

class RandomPolygons : public ::testing::Test {
 protected:
  /// Of any size, at most `size_px`; some on whole pixels, some without an area, some far outside.
  void add(std::uint32_t object, const Mask& mask, double size_px, Polygons& polygons) {
    const auto number = [&](double from, double to) {
      return std::uniform_real_distribution<double>(from, to)(random);
    };
    const double size = number(0, size_px);
    const Eigen::Vector2d middle(number(-0.3, 1.3) * mask.width(),
                                 number(-0.3, 1.3) * mask.height());
    const auto kind = random() % 6;
    const int corners = 3 + static_cast<int>(random() % 30);
    for (int i = 0; i < corners; ++i) {
      Eigen::Vector2d corner = middle + size * Eigen::Vector2d(number(-1, 1), number(-1, 1));
      if (kind == 0) corner = corner.array().round();
      if (kind == 1) corner.x() = middle.x() + number(0, 0.6);
      if (kind == 2) corner.y() = middle.y() + number(0, 1.2);
      if (kind == 3 && i == 1) corner *= 1e4;
      if (kind == 4) corner = middle;
      polygons.add_corner(corner);
    }
    polygons.end_polygon(object);
  }

  void expect_equal(std::vector<Mask> masks, const std::vector<Polygons>& polygons,
                    std::size_t objects, bool is_blank) {
    std::vector<Mask> expected = masks;
    std::vector<MaskDrawing> drawings[2];
    for (std::size_t i = 0; i < masks.size(); ++i) {
      const int margin_px = static_cast<int>(random() % 34);
      const Rect part = join(polygons[i].bounds(masks[i].bounds()), bounding_box(masks[i]));
      for (int by = 0; by < 2; ++by) {
        drawings[by].push_back({&polygons[i], margin_px, is_blank, part,
                                by == 0 ? &expected[i] : &masks[i],
                                std::vector<std::uint8_t>(objects, 0)});
      }
    }
    by_cpu->draw(drawings[0]);
    by_gpu.draw(drawings[1]);
    EXPECT_EQ(masks, expected);
    for (std::size_t i = 0; i < masks.size(); ++i) {
      EXPECT_EQ(drawings[0][i].covers, drawings[1][i].covers);
      for (const std::uint8_t covers : drawings[0][i].covers) ++(covers != 0 ? drawn : not_drawn);
    }
  }

  std::mt19937 random{7};
  std::unique_ptr<MaskDrawer> by_cpu = Registry<MaskDrawer>::get("cpu")();
  gl::GpuMaskDrawer by_gpu;
  int drawn = 0, not_drawn = 0;  ///< objects
};

TEST_F(RandomPolygons, AreTheCpusOnTheGpu) {
  for (int i = 0; i < 60; ++i) {
    std::vector<Mask> masks;
    std::vector<Polygons> polygons;
    const std::size_t objects = random() % 5;
    for (const auto& [width, height] :
         {std::pair{320, 200}, {97, 61}, {33, 1}, {1, 40}, {64, 64}}) {
      Mask& mask = masks.emplace_back(width, height, std::uint8_t{0});
      for (int k = 0; i % 2 == 1 && k < 5; ++k) {
        mask(static_cast<int>(random() % width), static_cast<int>(random() % height)) = 255;
      }
      polygons.emplace_back();
      for (std::uint32_t object = 0; object < objects; ++object) {
        for (std::size_t k = random() % 4; k > 0; --k) {
          add(object, mask, i % 3 == 0 ? 300 : 10, polygons.back());
        }
      }
    }
    expect_equal(masks, polygons, objects, i % 2 == 0);
  }
  EXPECT_GT(drawn, 50);
  EXPECT_GT(not_drawn, 50);
}

TEST_F(RandomPolygons, MayBeMoreThanADispatchHasInOneDirection) {
  std::vector<Mask> masks(1, Mask(640, 480, 0));
  std::vector<Polygons> polygons(1);
  for (int i = 0; i < 70000; ++i) add(0, masks[0], 2, polygons[0]);
  expect_equal(masks, polygons, 1, true);
  EXPECT_EQ(drawn, 1);
}

}  // namespace
}  // namespace diminish
