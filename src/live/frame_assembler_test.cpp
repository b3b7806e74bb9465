#include "live/frame_assembler.h"

#include <gmock/gmock.h>

#include <set>

namespace diminish {
namespace {

using ::testing::HasSubstr;
using testing::Optional;

constexpr double period_s = 1.0 / 30;

class Assembler : public ::testing::Test {
 protected:
  Assembler() {
    inboxes_.reserve(2);
    for (const char* name : {"rgbd0", "rgbd1"}) {
      inboxes_.push_back(std::make_unique<CameraInbox>(name, sensor_, sensor_));
    }
    assembler_.emplace(color_, std::vector<CameraInbox*>{inboxes_[0].get(), inboxes_[1].get()});
  }

  static void put(CameraInbox& inbox, Sensor sensor, double stamp_s, double arrival_s) {
    CameraImage image;
    image.sensor = sensor;
    image.stamp_s = stamp_s;
    const auto value = static_cast<std::uint8_t>(std::lround(stamp_s / period_s));
    image.color.resize(4, 3, Bgr{value, 0, 0});
    image.depth.resize(4, 3, value);
    std::string problem;
    ASSERT_EQ(inbox.put(image, arrival_s, problem), CameraInbox::Verdict::accepted) << problem;
  }
  void put_color(int i, double delay_s = 0.005) {
    put(color_, Sensor::color, i * period_s, i * period_s + delay_s);
  }
  void put_rgbd(int camera, int i, double offset_s = 0) {
    for (const Sensor sensor : {Sensor::color, Sensor::depth}) {
      put(*inboxes_[static_cast<std::size_t>(camera)], sensor, i * period_s + offset_s,
          i * period_s + offset_s + 0.02);
    }
  }
  std::optional<std::size_t> assemble(double now_s) {
    return assembler_->assemble(
        settings_, now_s, [this](std::size_t k) { return expected_[k]; }, frame_, pixels_);
  }

  Intrinsics sensor_{.width = 4, .height = 3};
  CameraInbox color_{"color", sensor_, std::nullopt};
  std::vector<std::unique_ptr<CameraInbox>> inboxes_;
  std::optional<FrameAssembler> assembler_;
  FrameAssembler::Settings settings_{.sync_tolerance_s = 0, .sync_wait_s = 0.06};
  std::array<bool, 2> expected_{true, true};
  FrameSet frame_;
  FrameAssembler::Pixels pixels_;
};

TEST_F(Assembler, WaitsForTheImagesOfAllCameras) {
  put_color(1);
  EXPECT_EQ(assemble(1 * period_s + 0.006), std::nullopt);
  put_rgbd(0, 1);
  EXPECT_EQ(assemble(1 * period_s + 0.021), std::nullopt);
  put_rgbd(1, 1);
  EXPECT_THAT(assemble(1 * period_s + 0.022), Optional(0U));
  EXPECT_EQ(frame_.color(0, 0).b, 1);
  for (const RgbdFrame& rgbd : frame_.rgbd) {
    EXPECT_TRUE(rgbd.available());
    EXPECT_EQ(rgbd.color(0, 0).b, 1);
    EXPECT_EQ(rgbd.depth(0, 0), 1);
    EXPECT_EQ(rgbd.color_stamp_s, period_s);
  }
  EXPECT_EQ(assemble(1 * period_s + 0.5), std::nullopt) << "no frame is made twice";
}

TEST_F(Assembler, TakesTheNewestCompleteOneAndCountsWhatItPassesOver) {
  for (int i = 1; i <= 4; ++i) put_color(i);
  for (int i = 1; i <= 3; ++i) {
    put_rgbd(0, i);
    put_rgbd(1, i);
  }
  EXPECT_THAT(assemble(4 * period_s + 0.006), Optional(2U));
  EXPECT_EQ(frame_.color(0, 0).b, 3);
  EXPECT_EQ(frame_.rgbd[1].depth(0, 0), 3);
}

TEST_F(Assembler, GoesOnWithoutACameraThatIsLate) {
  put_color(1);
  put_rgbd(1, 1);
  EXPECT_EQ(assemble(period_s + 0.06), std::nullopt);
  EXPECT_THAT(assembler_->next_deadline_s(settings_),
              Optional(testing::DoubleNear(period_s + 0.065, 1e-9)));
  EXPECT_THAT(assemble(period_s + 0.066), Optional(0U));
  EXPECT_FALSE(frame_.rgbd[0].available());
  EXPECT_THAT(frame_.rgbd[0].missing, HasSubstr("rgbd0: no color image within"));
  EXPECT_TRUE(frame_.rgbd[1].available());
}

TEST_F(Assembler, WaitsAsLongAsTheLastImagesMadeItWait) {
  settings_.sync_wait_s = 0;
  expected_ = {true, false};
  EXPECT_DOUBLE_EQ(assembler_->sync_wait_s(settings_), 0.06);
  constexpr double delay_s = 0.1;  // of the RGB-D camera, beyond the colour camera's
  for (int i = 1; i <= 6; ++i) {
    put_color(i);
    if (i <= 3) continue;
    for (const Sensor sensor : {Sensor::color, Sensor::depth}) {
      put(*inboxes_[0], sensor, (i - 3) * period_s, (i - 3) * period_s + 0.005 + delay_s);
    }
  }
  EXPECT_NEAR(assembler_->sync_wait_s(settings_), delay_s + 0.02, 1e-9);
  EXPECT_THAT(assemble(6 * period_s + 0.006), Optional(2U));
  EXPECT_TRUE(frame_.rgbd[0].available());
  EXPECT_EQ(assemble(4 * period_s + 0.005 + delay_s), std::nullopt);
}

TEST_F(Assembler, DoesNotWaitForACameraThatIsGone) {
  expected_ = {false, true};
  put_color(1);
  put_rgbd(1, 1);
  EXPECT_THAT(assemble(period_s + 0.021), Optional(0U));
  EXPECT_FALSE(frame_.rgbd[0].available());
}

TEST_F(Assembler, TakesTheRgbdImagesNearestInTime) {
  for (int i = 1; i <= 3; ++i) put_color(i);
  for (int i = 0; i <= 3; ++i) {
    put_rgbd(0, i, 0.25 * period_s);
    put_rgbd(1, i, -0.4 * period_s);
  }
  EXPECT_THAT(assemble(4 * period_s), Optional(2U));
  EXPECT_NEAR(frame_.rgbd[0].color_stamp_s, 3.25 * period_s, 1e-9);
  EXPECT_NEAR(frame_.rgbd[1].depth_stamp_s, 2.6 * period_s, 1e-9);
}

TEST_F(Assembler, TwoFramesMayShareASlowCamerasImage) {
  settings_.sync_tolerance_s = 1.1 * period_s;
  put_rgbd(0, 2);
  put_rgbd(1, 2);
  for (int i = 1; i <= 3; ++i) {
    put_color(i);
    EXPECT_THAT(assemble(4 * period_s), Optional(0U));
    EXPECT_EQ(frame_.color(0, 0).b, i);
    EXPECT_EQ(frame_.rgbd[0].depth(0, 0), 2);
  }
}

TEST_F(Assembler, HandsImagesOverWithoutACopy) {
  CameraImage image;
  image.stamp_s = period_s;
  image.color.resize(4, 3, Bgr{7, 0, 0});
  const Bgr* const delivered = image.color.data();
  std::string problem;
  color_.put(image, period_s, problem);
  put_rgbd(0, 1);
  put_rgbd(1, 1);
  ASSERT_TRUE(assemble(2 * period_s));
  EXPECT_EQ(frame_.color.view().data(), delivered);

  // They stay as they are for as long as the frame is kept, whatever else comes in.
  const FrameSet copy = frame_;
  for (int i = 2; i < 20; ++i) {
    put_color(i);
    put_rgbd(0, i);
    put_rgbd(1, i);
  }
  EXPECT_EQ(frame_.color(3, 2).b, 7);
  EXPECT_EQ(frame_.rgbd[1].depth(3, 2), 1);
  EXPECT_EQ(copy.color(3, 2).b, 7);

  // Nobody keeps these, so that later ones use their memory.
  std::set<const Bgr*> memory;
  for (int i = 20; i < 100; ++i) {
    image.stamp_s = i * period_s;
    image.color.resize(4, 3, Bgr{8, 0, 0});
    memory.insert(image.color.data());
    color_.put(image, i * period_s, problem);
  }
  EXPECT_LE(memory.size(), ImageHistory<Bgr>::capacity + 3);
}

TEST_F(Assembler, FollowsACameraWhoseClockIsReset) {
  expected_ = {false, false};
  put_color(100);
  EXPECT_TRUE(assemble(101 * period_s));
  for (int i = 1; i <= 10; ++i) {  // refused, until the camera is believed
    CameraImage image;
    image.stamp_s = i * period_s;
    image.color.resize(4, 3, Bgr{static_cast<std::uint8_t>(i), 0, 0});
    std::string problem;
    color_.put(image, 102 * period_s, problem);
  }
  EXPECT_TRUE(assemble(103 * period_s));
  EXPECT_EQ(frame_.color(0, 0).b, 10);
}

}  // namespace
}  // namespace diminish
