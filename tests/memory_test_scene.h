#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "analytic_scene.h"
#include "core/channels.h"
#include "memory/memory_stage.h"
#include "scene/scene_sampler.h"

namespace diminish::testing {

inline constexpr Rect hidden{100, 80, 120, 90};  ///< in the picture, around the box

/// One moment after the other, with what an RGB-D camera beside the user's sees of a wall and a
/// box.
class MemoryTest : public ::testing::Test {
 protected:
  struct Moment {
    double stamp_s = 0;
    bool has_box = true;
    double box_m = 0;           ///< how far the box has moved sidewards
    Rect object = {};           ///< to remove, in the picture
    Rect hole = {};             ///< in the object
    bool is_witnessed = true;   ///< the RGB-D camera delivers
    double user_m = 0;          ///< how far the user has moved sidewards
    double rgbd_m = 0;          ///< and the RGB-D camera
    double rgbd_turn = 0;       ///< an error of both cameras' poses in the world; radians
    double light = 1;           ///< everywhere: the share that is left
    double wave_m = 0;          ///< of the wall's pattern; 0: the usual
    double turn = 0;            ///< an error of the user's camera's pose, about its axis; radians
    bool is_lost = false;       ///< the object is not found
    bool is_in_doubt = false;   ///< the RGB-D camera does not fit the picture
    bool has_pose = true;       ///< the user's camera's is known
    bool has_world = true;      ///< else only the cameras' places relative to each other are known
    double moved_m = 0;         ///< all cameras, sidewards
    bool is_elsewhere = false;  ///< another wall
  };

  /// What the user sees, and where it comes from.
  const Reconstruction& show(const Moment& moment) {
    AnalyticScene scene;
    scene.has_box = moment.has_box;
    scene.box_min.x() += moment.box_m;
    scene.box_max.x() += moment.box_m;
    if (moment.wave_m > 0) scene.wave_m = moment.wave_m;
    if (moment.is_elsewhere) scene.wave_m = 0.1;
    const Eigen::Vector3d moved{moment.moved_m, 0, 0};
    const Eigen::Vector3d user{moment.user_m, 0, 0};
    const Eigen::Vector3d rgbd{moment.rgbd_m, 0, 0};
    AnalyticFrame now(scene, {Eigen::Vector3d(-0.25, 0.05, 1.1) + moved + rgbd},
                      LensModel::plumb_bob, Eigen::Vector3d(0.05, 0.02, 1.2) + moved + user);
    for (Image<Bgr>* image : {&now.frame.color.own(), &now.frame.rgbd[0].color.own()}) {
      for (Bgr& color : *image)
        color = to_color(static_cast<float>(moment.light) * to_channels(color));
    }
    truth = now.frame.color.own();
    now.frame.stamp_s = moment.stamp_s;
    if (!moment.is_witnessed) {
      now.frame.rgbd[0].missing = "rgbd0: lost";
      now.poses.depth_from_world[0].reset();
      now.poses.color_from_depth[0].reset();
    }
    RigidTransform error;
    error.rotation = Eigen::AngleAxisd(moment.turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    now.poses.color_from_world = error * *now.poses.color_from_world;
    if (moment.rgbd_turn != 0) {
      error.rotation =
          Eigen::AngleAxisd(moment.rgbd_turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
      now.poses.depth_from_world[0] = error * *now.poses.depth_from_world[0];
      now.poses.color_from_world = *now.poses.color_from_depth[0] * *now.poses.depth_from_world[0];
    }
    if (!moment.has_world || !moment.has_pose) {
      now.poses.color_from_world.reset();
      now.poses.depth_from_world[0].reset();
    }
    if (!moment.has_pose) now.poses.color_from_depth[0].reset();
    OcclusionMasks masks = empty_masks(now.rig);
    masks.color.fill(moment.object, 255);
    masks.color.fill(moment.hole, 0);
    for (int y = moment.object.y; y < moment.object.bottom(); ++y) {
      for (int x = moment.object.x; x < moment.object.right(); ++x) {
        if (masks.color(x, y) != 0) now.frame.color.own()(x, y) = {255, 0, 255};
      }
    }
    TiledRegion region(intersect(grow(moment.object, 16), now.rig.color.bounds()));
    drawer->reconstruct(now.frame, depths_of(now.frame), now.poses, masks, region, options, result);
    live = result;
    sampler.sample(now.frame, now.poses, masks, samples);
    OccluderReport report;
    if (moment.is_lost) report.message = "board: not found";
    const RecallInputs inputs{now.frame, now.poses,         masks, moment.object, region,
                              options,   moment.is_in_doubt};
    memory.recall(inputs);
    memory.learn(inputs, samples, {report}, nullptr, memory_report = {});
    memory.merge(inputs, maps, result, memory_report);
    return result;
  }

  static std::size_t count(const Reconstruction& drawn, std::uint8_t source) {
    return count_equal(drawn.source, source, hidden);
  }
  /// The mean difference from the truth, of what comes from `source`; levels.
  double error(const Reconstruction& drawn, std::uint8_t source) const {
    double sum = 0;
    int count = 0;
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        if (drawn.source(x, y) != source) continue;
        const Bgra shown = drawn.color(x, y);
        const Bgr real = truth(x, y);
        sum +=
            (std::abs(shown.b - real.b) + std::abs(shown.g - real.g) + std::abs(shown.r - real.r)) /
            3.;
        ++count;
      }
    }
    return count > 0 ? sum / count : 0;
  }
  /// The pixels that show the box, whose red is like nothing else.
  static int count_box(const Reconstruction& drawn) {
    int found = 0;
    for (int y = hidden.y; y < hidden.bottom(); ++y) {
      for (int x = hidden.x; x < hidden.right(); ++x) {
        const Bgra shown = drawn.color(x, y);
        found += drawn.source(x, y) != 0 && shown.r > 200 && shown.b < 60 ? 1 : 0;
      }
    }
    return found;
  }

  const Rig rig = small_rig();
  Options options = [] {
    Options on;
    on.memory = "on";
    return on;
  }();
  std::unique_ptr<Reconstructor> drawer = Registry<Reconstructor>::get("cpu")(rig);
  SceneSampler sampler{rig};
  SceneSamples samples;
  MemoryStage memory{rig};
  std::vector<ColorMap> maps = std::vector<ColorMap>(256);
  Reconstruction live;    ///< the last moment's, without memory
  Reconstruction result;  ///< with it
  MemoryReport memory_report;
  Image<Bgr> truth;
  static constexpr std::size_t pixels = std::size_t{hidden.width} * hidden.height;
};

}  // namespace diminish::testing
