#include "scene/stream_delay.h"

#include <gtest/gtest.h>

#include <cmath>

namespace diminish {
namespace {

constexpr double frames_per_second = 30;
constexpr float wall_m = 2;

/// A patterned wall, before which something bright passes: as the user's camera sees it now, and an
/// RGB-D camera, whose colours are darker, a while ago. The user's camera moves to the right.
class StreamDelayTest : public ::testing::Test {
 protected:
  static Bgr color_at(double x_m, double y_m, double stamp_s, double speed) {
    const double from_middle = x_m + 0.3 - speed * stamp_s;
    const bool is_thing = std::abs(from_middle) < 0.12 && std::abs(y_m) < 0.25;
    const double wave = 25 * std::sin(20 * x_m) * std::cos(17 * y_m);
    const auto level = static_cast<std::uint8_t>(std::lround((is_thing ? 190 : 90) + wave));
    return {level, level, level};
  }

  RigidTransform pose(double stamp_s) const {
    return {Eigen::Matrix3d::Identity(), Eigen::Vector3d(-camera_speed * stamp_s, 0, 0)};
  }
  Image<Bgr> picture(double stamp_s, double speed) const {
    Image<Bgr> picture(camera.width, camera.height);
    const double eye_m = -pose(stamp_s).translation.x();
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        picture(x, y) = color_at(eye_m + (x - camera.cx) / camera.fx * wall_m,
                                 (y - camera.cy) / camera.fy * wall_m, stamp_s, speed);
      }
    }
    return picture;
  }
  SceneSamples samples(double stamp_s, double late_s, double speed) const {
    SceneSamples samples;
    const double eye_m = -pose(stamp_s).translation.x();
    for (int y = 4; y < camera.height; y += 6) {
      for (int x = 4; x < camera.width; x += 6) {
        SceneSample sample;
        sample.point_m = {static_cast<float>((x - camera.cx) / camera.fx) * wall_m,
                          static_cast<float>((y - camera.cy) / camera.fy) * wall_m, wall_m};
        sample.pixel = {static_cast<float>(x), static_cast<float>(y)};
        const Bgr seen =
            color_at(eye_m + sample.point_m.x(), sample.point_m.y(), stamp_s - late_s, speed);
        const auto darker = static_cast<std::uint8_t>(0.7 * seen.b + 5);
        sample.color = {darker, darker, darker};
        sample.source = 1;
        samples.surfaces.push_back(sample);
      }
    }
    return samples;
  }
  /// After so many frames in time, and late ones.
  std::optional<double> found(double late_s, double speed, int good_frames = 0,
                              int late_frames = 15) const {
    StreamDelay delay(camera);
    const Mask nothing(camera.width, camera.height, 0);
    std::vector<std::optional<double>> late(1);
    for (int i = 0; i < good_frames + late_frames; ++i) {
      const double stamp_s = i / frames_per_second;
      const Image<Bgr> shown = picture(stamp_s, speed);
      const SceneSamples seen = samples(stamp_s, i < good_frames ? 0 : late_s, speed);
      delay.find({shown, stamp_s, pose(stamp_s), nothing, seen}, late);
    }
    return late[0];
  }

  Intrinsics camera{320, 240, 300, 300, 160, 120, {}};
  double camera_speed = 0.1;  ///< m/s
};

TEST_F(StreamDelayTest, IsFoundFromWhatMoves) {
  for (const double late_s : {0.1, 0.15, 0.2}) {
    const auto delay_s = found(late_s, 1);
    ASSERT_TRUE(delay_s) << late_s;
    EXPECT_NEAR(*delay_s, late_s, 0.04);
  }
}

TEST_F(StreamDelayTest, IsFoundInTheFirstFrameThatIsLate) {
  EXPECT_FALSE(found(0.15, 1, 15, 0));
  const auto delay_s = found(0.15, 1, 15, 1);
  ASSERT_TRUE(delay_s);
  EXPECT_NEAR(*delay_s, 0.15, 0.04);
}

TEST_F(StreamDelayTest, IsNoneOfAGoodCamera) {
  EXPECT_FALSE(found(0, 1));
}

TEST_F(StreamDelayTest, IsNoneWhereNothingMoves) {
  EXPECT_FALSE(found(0.15, 0));
}

}  // namespace
}  // namespace diminish
