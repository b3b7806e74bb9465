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
    std::ofstream(folder.path() / (name + ".txt")) << line(0, camera_from_world);
  }
  /// As TUM's lists have it.
  static std::string line(double stamp_s, const RigidTransform& camera_from_world) {
    const RigidTransform pose = camera_from_world.inverse();
    const Eigen::Quaterniond turn(pose.rotation);
    const Eigen::Vector3d& at = pose.translation;
    return fmt::format("{:.6f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f} {:.12f}\n", stamp_s,
                       at.x(), at.y(), at.z(), turn.x(), turn.y(), turn.z(), turn.w());
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

// The user's camera is the only one. It moves between what it remembers and what it shows, so that
// only the right plane puts the wall's pattern in its place.
class LoneCamera : public PosterWall {
 protected:
  /// What it shows of the patch, seen by the user 0.2 m beside where the keyframe was taken; dB.
  double quality_with(const std::vector<GivenPlane>& planes) {
    scene.planes = planes;
    testing::AnalyticFrame before({.has_box = false}, {}, LensModel::plumb_bob,
                                  Eigen::Vector3d(-0.15, 0.02, 1.2));
    testing::AnalyticFrame now({.has_box = false}, {}, LensModel::plumb_bob,
                               Eigen::Vector3d(0.05, 0.02, 1.2));
    write_poses({{0, *before.poses.color_from_world}, {2, *now.poses.color_from_world}});
    Rig rig = now.rig;
    rig.pose_source = "file";
    folder.write("lone.yaml", "source: file\nfiles: {color: color.txt}\n");
    rig.pose = Config::load(folder.path() / "lone.yaml");
    Options options;
    options.memory = "on";
    Pipeline pipeline(rig, scene, options);
    const Intrinsics& color = rig.color;
    GivenMask nothing{"patch", Mask(color.width, color.height, 0), {}};
    DiminishedFrame result;
    before.frame.masks = {nothing};
    pipeline.process(before.frame, result);
    copy(now.frame.color.view(), truth);
    now.frame.masks = {nothing};
    now.frame.masks[0].color.fill(patch, 255);
    now.frame.color.own().fill(patch, Bgr{255, 0, 255});
    // A keyframe is ready after two frames.
    for (int i = 0; i < 3; ++i) {
      now.frame.stamp_s = 2 + 0.03 * i;
      pipeline.process(now.frame, result);
    }
    remembered = result.report.remembered_pixels;
    EXPECT_EQ(result.report.valid_pixels, remembered) << "nobody sees it now";
    Mask inside(truth.width(), truth.height(), 0);
    inside.fill(patch, 255);
    return testing::psnr_db(result.picture, truth, inside);
  }
  void write_poses(const std::vector<std::pair<double, RigidTransform>>& color_from_world) const {
    std::ofstream file(folder.path() / "color.txt");
    for (const auto& [stamp_s, pose] : color_from_world) {
      for (const double later_s : {0., 0.03, 0.06}) file << line(stamp_s + later_s, pose);
    }
  }

  std::size_t remembered = 0;
};

TEST_F(LoneCamera, RemembersWhatLiesOnAPlane) {
  const double by_plane = quality_with({GivenPlane{}});
  EXPECT_GT(remembered, std::size_t{patch.width} * patch.height * 9 / 10);
  EXPECT_GT(by_plane, 30);
  // A plane that is only nearer would do as well: the keyframe is moved until it fits the picture.
  GivenPlane tilted;
  tilted.normal = {0.6, 0, 0.8};
  EXPECT_LT(quality_with({tilted}), by_plane - 6);
}

TEST_F(LoneCamera, RemembersNothingBesideThePlane) {
  GivenPlane elsewhere;
  elsewhere.corners = {{2, 2, 0}, {3, 2, 0}, {3, 3, 0}, {2, 3, 0}};
  quality_with({elsewhere});
  EXPECT_EQ(remembered, 0U);
}

}  // namespace
}  // namespace diminish
