#include "remote/node_worker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace diminish {
namespace {

using ::testing::HasSubstr;

const Mask color_mask(64, 48);
const Mask depth_mask(40, 32);
const RigidTransform pose;
const Options options;

class NodeWorkerTest : public ::testing::Test {
 protected:
  NodeWorkerTest() { add_images(64, 48); }

  void add_images(int width, int height) {
    const auto made = std::make_shared<RgbdFrame>();
    made->color = Image<Bgr>(width, height, {90, 100, 110});
    made->depth = Image<std::uint16_t>(40, 32, 1000);
    made->color_stamp_s = made->depth_stamp_s = 10;
    images_ = made;
  }

  static GlanceQuestion question() {
    GlanceQuestion asked;
    asked.stamp_s = 10;
    asked.tolerance_s = 0.01;
    asked.patience_s = 0.5;
    asked.camera.name = "camera";
    asked.camera.color = {64, 48, 60, 60, 31.5, 23.5, {}};
    asked.camera.depth = {40, 32, 40, 40, 19.5, 15.5, {}};
    asked.user = {96, 64, 80, 80, 47.5, 31.5, {}};
    asked.wishes = {"", {1, 2, 4}, 60};
    return asked;
  }
  void ask_glance(std::uint64_t user, std::uint64_t frame, double now_s,
                  const GlanceQuestion& asked = question()) {
    worker_.take(write_question({NodeTopic::glance, user, frame}, asked), now_s);
  }
  void ask_layer(std::uint64_t user, std::uint64_t frame, double now_s) {
    worker_.take(write_question({NodeTopic::layer, user, frame},
                                {pose, color_mask, depth_mask, region_, options}, {false, 0, 1e-4}),
                 now_s);
  }
  /// Of the last answer.
  AnswerHead last() const { return open_answer(answers_.back()).head; }

  const TiledRegion region_{Rect{20, 15, 50, 30}};
  NodeWorker::Images images_;
  std::vector<std::vector<std::uint8_t>> answers_;
  NodeWorker worker_{
      [this](double stamp_s, double tolerance_s) -> NodeWorker::Images {
        const bool is_near = images_ && std::abs(stamp_s - 10) <= tolerance_s;
        return is_near ? images_ : nullptr;
      },
      [this](const std::vector<std::uint8_t>& answer) { answers_.push_back(answer); }};
};

// A wall at 1 m in front of cameras in the same place.
TEST_F(NodeWorkerTest, DrawsWhatItIsAskedFor) {
  ask_glance(1, 5, 0);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(last().problem, "");
  EXPECT_EQ(last().frame, 5U);
  ask_layer(1, 5, 0);
  ASSERT_EQ(answers_.size(), 2U);
  auto message = open_answer(answers_.back());
  EXPECT_EQ(message.head.topic, NodeTopic::layer);
  RemoteLayer layer;
  layer.region = {region_.x, region_.y, region_.width, region_.height};
  read(message.rest, layer);
  std::size_t drawn = 0;
  for (int y = 0; y < layer.inverse_z.height(); ++y) {
    for (int x = 0; x < layer.inverse_z.width(); ++x) {
      if (layer.inverse_z(x, y) == 0) continue;
      ++drawn;
      EXPECT_NEAR(layer.inverse_z(x, y), 1, 1e-3);
      EXPECT_EQ(layer.color(x, y), (Bgr{90, 100, 110}));
    }
  }
  EXPECT_EQ(drawn, layer.inverse_z.size());
  // The camera's pixels are 4/3 as large as the user's.
  EXPECT_NEAR(layer.resolution(1, 1), 9. / 16, 0.01);
}

TEST_F(NodeWorkerTest, AQuestionWaitsForItsImages) {
  const auto late = std::exchange(images_, nullptr);
  ask_glance(1, 1, 100);
  EXPECT_TRUE(answers_.empty());
  EXPECT_TRUE(worker_.has_waiting());
  worker_.look_again(100.2);
  EXPECT_TRUE(answers_.empty());
  images_ = late;
  worker_.look_again(100.3);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(last().problem, "");
  EXPECT_FALSE(worker_.has_waiting());
}

TEST_F(NodeWorkerTest, ItsPatienceEnds) {
  images_ = nullptr;
  ask_glance(1, 1, 100);
  worker_.look_again(100.6);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(last().problem, "no images within 0.01 s");
  EXPECT_FALSE(worker_.has_waiting());
}

TEST_F(NodeWorkerTest, ImagesOfAnotherSizeAreSaid) {
  add_images(32, 24);
  ask_glance(1, 1, 0);
  ASSERT_EQ(answers_.size(), 1U);
  EXPECT_EQ(last().problem, "its colour images have 32x24 pixels, the user's rig.yaml says 64x48");
}

TEST_F(NodeWorkerTest, UsersAreKeptApart) {
  ask_glance(1, 1, 0);
  GlanceQuestion other = question();
  other.user = {48, 32, 40, 40, 23.5, 15.5, {}};
  ask_glance(2, 9, 0, other);
  ask_layer(1, 1, 0);
  ASSERT_EQ(answers_.size(), 3U);
  EXPECT_EQ(last().user, 1U);
  EXPECT_EQ(last().problem, "");
  // The region is beyond the other's picture.
  ask_layer(2, 9, 0);
  EXPECT_EQ(answers_.size(), 3U);
  EXPECT_EQ(worker_.counts().failed, 1U);
  EXPECT_THAT(worker_.counts().problem, HasSubstr("expected a region of the picture"));
  EXPECT_EQ(worker_.users(0), 2U);
  EXPECT_EQ(worker_.users(5), 0U);
}

TEST_F(NodeWorkerTest, LateReorderedAndUnknownQuestionsCostThemselves) {
  ask_layer(7, 1, 0);  // of nobody
  EXPECT_TRUE(answers_.empty());
  ask_glance(1, 1, 0);
  ask_layer(1, 2, 0);  // a glance that was lost
  ASSERT_EQ(answers_.size(), 2U);
  EXPECT_EQ(last().problem, "its images are gone");
  worker_.take(std::vector<std::uint8_t>{1, 2, 3}, 0);
  EXPECT_EQ(worker_.counts().failed, 1U);
  for (std::uint64_t frame = 2; frame < 30; ++frame) ask_glance(1, frame, 0);
  ask_layer(1, 1, 0);
  EXPECT_EQ(last().problem, "its images are gone");
  ask_layer(1, 28, 0);
  EXPECT_EQ(last().problem, "");
  for (std::uint64_t user = 100; user < 130; ++user) ask_glance(user, 1, 1);
  EXPECT_LE(worker_.users(1), 8U);
}

}  // namespace
}  // namespace diminish
