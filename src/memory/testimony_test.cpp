#include "memory/testimony_comparison.h"

#include <gtest/gtest.h>

#include "memory/keyframe.h"

namespace diminish {
namespace {

constexpr int width = 320;
constexpr int height = 240;
constexpr float wall_m = 2;
constexpr float box_m = 1.5F;
/// In the depth image.
constexpr Rect box{120, 80, 60, 60};

RgbdCamera camera() {
  RgbdCamera camera;
  camera.name = "rgbd0";
  camera.depth.width = camera.color.width = width;
  camera.depth.height = camera.color.height = height;
  camera.depth.fx = camera.depth.fy = camera.color.fx = camera.color.fy = 300;
  camera.depth.cx = camera.color.cx = (width - 1) / 2.;
  camera.depth.cy = camera.color.cy = (height - 1) / 2.;
  return camera;
}

/// A wall of several colours; in front of it, where wanted, a box. side_m: how far the camera has
/// moved to the right.
struct View {
  bool has_box = false;
  double side_m = 0;
  Bgr box_color{40, 160, 60};
  float light = 1;

  RgbdFrame images() const {
    const RgbdCamera model = camera();
    Image<Bgr> color(width, height);
    Image<std::uint16_t> depth(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double shift_px = model.depth.fx * side_m / box_m;
        const bool on_box = has_box && box.contains(static_cast<int>(x + shift_px), y);
        const float z = on_box ? box_m : wall_m;
        depth(x, y) = static_cast<std::uint16_t>(1000 * z);
        // A pattern on the wall, fixed to it.
        const double place = (x - model.depth.cx) / model.depth.fx * z + side_m;
        const int stripe = static_cast<int>(std::floor(place / 0.2)) & 1;
        const Bgr own =
            on_box ? box_color : (stripe != 0 ? Bgr{120, 130, 150} : Bgr{150, 120, 110});
        const auto lit = [&](std::uint8_t level) {
          return static_cast<std::uint8_t>(light * static_cast<float>(level));
        };
        color(x, y) = {lit(own.b), lit(own.g), lit(own.r)};
      }
    }
    RgbdFrame frame;
    frame.color = std::move(color);
    frame.depth = std::move(depth);
    return frame;
  }

  Testimony testimony(const TestimonyTaker& taker) const {
    RigidTransform depth_from_world;
    depth_from_world.translation.x() = -side_m;
    const Mask clear(width, height, std::uint8_t{0});
    Testimony result;
    taker.take(images(), depth_from_world, clear, clear, result);
    return result;
  }
};

class Testimonies : public ::testing::Test {
 protected:
  void compare(const View& then, const View& now) {
    compare(then.testimony(taker), now.testimony(taker));
  }
  void compare(const Testimony& then, const Testimony& now) {
    comparison.compare({then, taker.grid().bounds(), then_by_now},
                       {now, taker.grid().bounds(), now_by_then});
  }
  static std::size_t count(const Verdicts& verdicts, Verdict verdict, const Rect& part) {
    std::size_t found = 0;
    for (int y = part.y; y < part.bottom(); ++y) {
      for (int x = part.x; x < part.right(); ++x) found += verdicts(x, y) == verdict ? 1 : 0;
    }
    return found;
  }
  static std::size_t count_changed(const Verdicts& verdicts) {
    std::size_t found = 0;
    for (const Verdict verdict : verdicts) found += is_changed(verdict) ? 1 : 0;
    return found;
  }

  /// Pixels around the box that may be mixed with its colour.
  static constexpr std::size_t rim = 40;
  TestimonyTaker taker{camera()};
  TestimonyComparison comparison{taker.grid()};
  Verdicts then_by_now, now_by_then;
  /// The box without its rim, on the testimony's grid.
  const int step = taker.grid().step();
  const Rect inner{box.x / step + 2, box.y / step + 2, box.width / step - 4, box.height / step - 4};
  const std::size_t pixels =
      static_cast<std::size_t>(inner.width) * static_cast<std::size_t>(inner.height);
};

TEST_F(Testimonies, AgreeIfNothingChanges) {
  compare({.has_box = true}, {.has_box = true});
  EXPECT_EQ(count_changed(then_by_now), 0U);
  EXPECT_EQ(count_changed(now_by_then), 0U);
  EXPECT_EQ(count(then_by_now, Verdict::same, inner), pixels);
}

TEST_F(Testimonies, SeeThatABoxHasGone) {
  compare({.has_box = true}, {.has_box = false});
  EXPECT_EQ(count(then_by_now, Verdict::gone, inner), pixels);
  // The wall behind it was not seen then: nothing is known of it.
  EXPECT_EQ(count(now_by_then, Verdict::unknown, inner), pixels);
  EXPECT_LE(count_changed(now_by_then), rim);
}

TEST_F(Testimonies, SeeThatABoxHasCome) {
  compare({.has_box = false}, {.has_box = true});
  EXPECT_EQ(count(now_by_then, Verdict::gone, inner), pixels);
  EXPECT_LE(count_changed(then_by_now), rim);
}

TEST_F(Testimonies, SeeOtherColours) {
  compare({.has_box = true}, {.has_box = true, .box_color = {60, 40, 160}});
  EXPECT_EQ(count(then_by_now, Verdict::recolored, inner), pixels);
}

TEST_F(Testimonies, AShadowIsNoChange) {
  compare({.has_box = true}, {.has_box = true, .light = 0.6F});
  EXPECT_EQ(count_changed(then_by_now), 0U);
}

TEST_F(Testimonies, OfAMovingCameraAgree) {
  compare({.has_box = true}, {.has_box = true, .side_m = 0.2});
  EXPECT_EQ(count_changed(then_by_now), 0U);
  EXPECT_EQ(count_changed(now_by_then), 0U);
  EXPECT_EQ(count(then_by_now, Verdict::same, inner), pixels);
}

TEST_F(Testimonies, OfAMovingCameraSeeThatABoxHasGone) {
  compare({.has_box = true}, {.has_box = false, .side_m = 0.2});
  EXPECT_EQ(count(then_by_now, Verdict::absent, inner), pixels);
}

// A pose that is wrong by two degrees would let the edges of everything change.
TEST_F(Testimonies, OfACameraThatStandsStillNeedNoPose) {
  const Testimony then = View{.has_box = true}.testimony(taker);
  Testimony now = then;
  now.depth_from_world.rotation =
      Eigen::AngleAxisd(0.035, Eigen::Vector3d::UnitY()).toRotationMatrix();
  compare(then, now);
  EXPECT_EQ(count_changed(then_by_now), 0U);
}

TEST_F(Testimonies, SayNothingWithoutImagesOrUnderAMask) {
  Testimony now;
  const Testimony then = View{.has_box = true}.testimony(taker);
  compare(then, now);
  EXPECT_EQ(count(then_by_now, Verdict::unknown, inner), pixels);

  Mask masked(width, height, std::uint8_t{0});
  masked.fill(box, 255);
  const Mask clear(width, height, std::uint8_t{0});
  taker.take(View{.has_box = true}.images(), RigidTransform(), masked, clear, now);
  compare(View{}.testimony(taker), now);
  EXPECT_LE(count_changed(then_by_now), rim);
  EXPECT_EQ(count(now_by_then, Verdict::unknown, inner), pixels);
}

}  // namespace
}  // namespace diminish
