#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>
#include <random>

#include "analytic_scene.h"
#include "diminish/occluder_settings.h"
#include "diminish/pipeline.h"
#include "picture_difference.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

/// A patterned wall, known as a plane or by a depth image, with the noise of real sensors.
class PosterWall : public ::testing::Test {
 protected:
  static constexpr Rect patch{90, 70, 110, 90};

  PosterWall() : scene_frame({.has_box = false}, {{-0.45, 0.3, 0.9}}), truth(clone()) {
    write_pose("color", *scene_frame.poses.color_from_world);
    write_pose("rgbd0", *scene_frame.poses.depth_from_world[0]);
    std::ofstream(folder.path() / "rig.yaml")
        << "source: file\nfiles: {color: color.txt, rgbd0: rgbd0.txt}\n";
    scene_frame.rig.pose_source = "file";
    scene_frame.rig.pose = Config::load(folder.path() / "rig.yaml");
    auto settings = std::make_shared<MaskSettings>();
    settings->color = "masks/color";
    scene.occluders = {{"patch", "mask", settings}};
    add_noise();
    FrameSet& frame = scene_frame.frame;
    const Intrinsics& color = scene_frame.rig.color;
    GivenMask mask{"patch", Mask(color.width, color.height, 0), std::vector<Mask>(1)};
    mask.color.fill(patch, 255);
    frame.masks.push_back(mask);
    frame.color.own().fill(patch, Bgr{255, 0, 255});
  }

  Image<Bgr> clone() {
    Image<Bgr> copied;
    copy(scene_frame.frame.color.view(), copied);
    return copied;
  }
  void write_pose(const std::string& name, const RigidTransform& camera_from_world) const {
    const RigidTransform pose = camera_from_world.inverse();
    const Eigen::Quaterniond turn(pose.rotation);
    const Eigen::Vector3d& at = pose.translation;
    std::ofstream(folder.path() / (name + ".txt"))
        << fmt::format("0 {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f}\n", at.x(),
                       at.y(), at.z(), turn.x(), turn.y(), turn.z(), turn.w());
  }
  /// 3 levels; 4 mm of depth.
  void add_noise() {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    const auto level = [&](std::uint8_t value) {
      return static_cast<std::uint8_t>(
          std::clamp(std::lround(value + 3 * normal(random)), 0L, 255L));
    };
    FrameSet& frame = scene_frame.frame;
    for (Image<Bgr>* const image : {&frame.color.own(), &frame.rgbd[0].color.own()}) {
      for (int y = 0; y < image->height(); ++y) {
        for (int x = 0; x < image->width(); ++x) {
          Bgr& pixel = (*image)(x, y);
          pixel = {level(pixel.b), level(pixel.g), level(pixel.r)};
        }
      }
    }
    Image<std::uint16_t>& depth = frame.rgbd[0].depth.own();
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 0; x < depth.width(); ++x) {
        const double noise = 0.004 / scene_frame.rig.rgbd[0].depth_unit_m * normal(random);
        depth(x, y) = static_cast<std::uint16_t>(depth(x, y) + std::lround(noise));
      }
    }
  }

  /// Of the patch, dB.
  double quality(const Rig& rig) const {
    DiminishedFrame result;
    Pipeline(rig, scene, {}).process(scene_frame.frame, result);
    EXPECT_EQ(result.report.missing_pixels, 0U);
    Mask inside(truth.width(), truth.height(), 0);
    inside.fill(patch, 255);
    return testing::psnr_db(result.picture, truth, inside);
  }

  TemporaryFolder folder;
  testing::AnalyticFrame scene_frame;
  Image<Bgr> truth;
  Scene scene;
};

TEST_F(PosterWall, IsShownAsWellByItsPlaneAsByItsDepth) {
  const double by_depth = quality(scene_frame.rig);
  GivenPlane wall;
  scene.planes = {wall};
  const double by_plane = quality(without_depth(scene_frame.rig));
  RecordProperty("by_depth_db", std::to_string(by_depth));
  RecordProperty("by_plane_db", std::to_string(by_plane));
  EXPECT_GT(by_depth, 25);
  EXPECT_GT(by_plane, by_depth - 1);
  // The right plane: one a tenth of a metre nearer is worse by far.
  scene.planes[0].point.z() = 0.1;
  EXPECT_LT(quality(without_depth(scene_frame.rig)), by_plane - 6);
}

// What the user saw before the object came, though no camera measures depth.
TEST_F(PosterWall, IsRememberedWhereOnlyItsPlaneIsKnown) {
  scene.planes = {GivenPlane{}};
  Options options;
  options.memory = "on";
  Pipeline pipeline(without_depth(scene_frame.rig), scene, options);
  FrameSet& frame = scene_frame.frame;
  DiminishedFrame result;
  const Image<Bgr> with_object = frame.color.own();
  const Mask object = frame.masks[0].color;
  frame.color.own() = truth;
  frame.masks[0].color.fill(0);
  pipeline.process(frame, result);
  EXPECT_EQ(result.report.memory.keyframes, 1U);
  frame.color.own() = with_object;
  frame.masks[0].color = object;
  frame.rgbd[0].missing = "rgbd0: lost";
  // A keyframe is ready after two frames.
  for (int i = 0; i < 3; ++i) pipeline.process(frame, result);
  EXPECT_GT(result.report.remembered_pixels, std::size_t{patch.width} * patch.height * 9 / 10);
  Mask inside(truth.width(), truth.height(), 0);
  inside.fill(patch, 255);
  EXPECT_GT(testing::psnr_db(result.picture, truth, inside), 35);
}

}  // namespace
}  // namespace diminish
