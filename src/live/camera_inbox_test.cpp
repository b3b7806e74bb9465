#include "live/camera_inbox.h"

#include <gmock/gmock.h>

#include <limits>

namespace diminish {
namespace {

using ::testing::HasSubstr;
using Verdict = CameraInbox::Verdict;

constexpr double now_s = 100;

class Inbox : public ::testing::Test {
 protected:
  Verdict put_color(double stamp_s, std::uint8_t value = 0, int width = 8) {
    CameraImage image;
    image.stamp_s = stamp_s;
    image.color.resize(width, 6, Bgr{value, 0, 0});
    return inbox_.put(image, now_s, problem_);
  }
  Verdict put_depth(double stamp_s) {
    CameraImage image;
    image.sensor = Sensor::depth;
    image.stamp_s = stamp_s;
    image.depth.resize(4, 3, 1000);
    return inbox_.put(image, now_s, problem_);
  }
  /// The blue of the colour image nearest to a time; -1 if there is none.
  int nearest_color(double stamp_s, double tolerance_s) {
    return inbox_.with_images([&](const auto& color, const auto&) {
      const auto* entry = color.nearest(stamp_s, tolerance_s);
      return entry ? static_cast<int>((*entry->image)(0, 0).b) : -1;
    });
  }

  CameraInbox inbox_{"rgbd0", Intrinsics{.width = 8, .height = 6},
                     Intrinsics{.width = 4, .height = 3}};
  std::string problem_;
};

TEST_F(Inbox, GivesTheImageNearestInTime) {
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(put_color(10 + i, static_cast<std::uint8_t>(i)), Verdict::accepted);
  EXPECT_EQ(nearest_color(11.4, 0.5), 1);
  EXPECT_EQ(nearest_color(11.6, 0.5), 2);
  EXPECT_EQ(nearest_color(11.5, 0.5), 1) << "the earlier of two equally near";
  EXPECT_EQ(nearest_color(14, 0.5), -1);
}

TEST_F(Inbox, KeepsOnlyTheNewest) {
  const int many = 3 * static_cast<int>(ImageHistory<Bgr>::capacity);
  for (int i = 0; i < many; ++i) put_color(10 + i, static_cast<std::uint8_t>(i));
  EXPECT_EQ(nearest_color(10, 0.4), -1);
  EXPECT_EQ(nearest_color(10 + many - 1, 0.4), many - 1);
}

TEST_F(Inbox, RefusesWhatCannotBeUsedAndSaysWhy) {
  EXPECT_EQ(put_color(10), Verdict::accepted);
  EXPECT_EQ(put_color(10), Verdict::duplicate);
  EXPECT_EQ(put_color(9), Verdict::out_of_order);
  EXPECT_THAT(problem_, HasSubstr("1 s before"));
  EXPECT_EQ(put_color(11, 0, 7), Verdict::wrong_size);
  EXPECT_THAT(problem_, HasSubstr("expected colour images of 8x6, got 7x6"));
  EXPECT_EQ(put_color(now_s + 60), Verdict::out_of_order);
  EXPECT_THAT(problem_, HasSubstr("60 s in the future"));
  EXPECT_EQ(put_color(std::numeric_limits<double>::quiet_NaN()), Verdict::out_of_order);
  CameraImage torn;
  torn.stamp_s = 12;
  torn.fault = "torn image";
  EXPECT_EQ(inbox_.put(torn, now_s, problem_), Verdict::damaged);
  EXPECT_EQ(problem_, "torn image");
  EXPECT_EQ(put_color(12), Verdict::accepted) << "what was refused leaves no trace";
}

TEST_F(Inbox, SensorsHaveTimesOfTheirOwn) {
  EXPECT_EQ(put_color(10), Verdict::accepted);
  EXPECT_EQ(put_depth(9), Verdict::accepted);
}

TEST_F(Inbox, ACameraWhoseClockWasResetIsBelievedAfterAWhile) {
  EXPECT_EQ(put_color(50, 1), Verdict::accepted);
  int refused = 0;
  double stamp_s = 10;
  while (put_color(stamp_s, 2) == Verdict::out_of_order && refused < 100) {
    ++refused;
    stamp_s += 0.03;
  }
  EXPECT_GE(refused, 3);
  EXPECT_LE(refused, 30);
  EXPECT_EQ(nearest_color(50, 1), -1) << "images of the old clock are gone";
  EXPECT_EQ(nearest_color(stamp_s, 0.001), 2);
}

TEST(ColorInbox, RefusesDepth) {
  CameraInbox inbox("color", Intrinsics{.width = 8, .height = 6}, std::nullopt);
  CameraImage image;
  image.sensor = Sensor::depth;
  image.depth.resize(8, 6, 1);
  std::string problem;
  EXPECT_EQ(inbox.put(image, now_s, problem), Verdict::wrong_size);
  EXPECT_EQ(problem, "expected colour images, got depth");
}

}  // namespace
}  // namespace diminish
