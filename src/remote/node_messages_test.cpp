#include "remote/node_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "expect_error.h"
#include "remote/layer_codec.h"

namespace diminish {
namespace {

constexpr NodeHead head{NodeTopic::layer, 0x123456789abcdef0, 7};

GlanceQuestion question() {
  GlanceQuestion asked;
  asked.asked_s = 5;
  asked.stamp_s = 100.25;
  asked.tolerance_s = 0.016;
  asked.patience_s = 0.1;
  asked.camera.name = "camera";
  asked.camera.color = {64, 48, 60, 61, 31.5, 24, {0.1, -0.2, 0.001, 0, 0.01}};
  asked.camera.depth = {40, 32, 40, 40, 20, 16, {}};
  asked.camera.depth.lens_model = LensModel::fisheye;
  asked.camera.depth_unit_m = 0.00025;
  asked.camera.color_from_depth.translation = {0.05, 0, 0.001};
  asked.user = {96, 64, 80, 80, 48, 32, {}};
  asked.wishes = {"DICT_4X4_50", {1, 2, 4}, 60};
  return asked;
}

Mask random_mask(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> length(1, 70);
  Mask mask(width, height);
  bool set = seed % 2 != 0;
  for (std::size_t i = 0; i < mask.size(); set = !set) {
    for (int n = length(random); n > 0 && i < mask.size(); --n) mask.data()[i++] = set ? 255 : 0;
  }
  return mask;
}

RemoteLayer random_layer(const Rect& region) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> level(0, 255);
  RemoteLayer layer;
  layer.region = region;
  layer.color.resize(region.width, region.height);
  layer.inverse_z.resize(region.width, region.height);
  for (Bgr& color : layer.color) {
    for (std::uint8_t* c : {&color.b, &color.g, &color.r}) {
      *c = static_cast<std::uint8_t>(level(random));
    }
  }
  for (float& inverse_z : layer.inverse_z) {
    inverse_z = level(random) < 60 ? 0 : 1 / (0.3F + static_cast<float>(level(random)) / 37);
  }
  layer.resolution.resize(region.width / 8, region.height / 8);
  for (float& value : layer.resolution) value = static_cast<float>(level(random)) / 100;
  return layer;
}

TEST(NodeMessages, AQuestionForAGlanceIsReadAsItWasWritten) {
  const GlanceQuestion asked = question();
  const auto bytes = write_question({NodeTopic::glance, head.user, head.frame}, asked);
  auto message = open_question(bytes);
  EXPECT_EQ(message.head.topic, NodeTopic::glance);
  EXPECT_EQ(message.head.user, head.user);
  EXPECT_EQ(message.head.frame, head.frame);
  GlanceQuestion back;
  read(message.rest, back);
  EXPECT_EQ(back.asked_s, asked.asked_s);
  EXPECT_EQ(back.stamp_s, asked.stamp_s);
  EXPECT_EQ(back.camera.color, asked.camera.color);
  EXPECT_EQ(back.camera.depth, asked.camera.depth);
  EXPECT_EQ(back.camera.depth_unit_m, asked.camera.depth_unit_m);
  EXPECT_EQ(back.camera.color_from_depth.translation, asked.camera.color_from_depth.translation);
  EXPECT_EQ(back.user, asked.user);
  EXPECT_EQ(back.wishes, asked.wishes);
}

TEST(NodeMessages, AQuestionForALayerIsReadAsItWasWritten) {
  const GlanceQuestion asked = question();
  RigidTransform pose;
  pose.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation = {0.1, -0.2, 3};
  const Mask color = random_mask(64, 48, 1);
  const Mask depth = random_mask(40, 32, 2);
  Mask object(96, 64);
  object.fill({30, 20, 5, 9}, 255);
  TiledRegion region(Rect{3, 5, 80, 50});
  region.keep_near(object, 4);
  ASSERT_FALSE(region.is_whole());
  Options options;
  options.smooth_depth = false;
  options.discontinuity_threshold_m = 0.07;
  const auto bytes = write_question(head, {pose, color, depth, region, options}, {true, 80, 2e-4});
  auto message = open_question(bytes);
  LayerQuestion back;
  read(message.rest, asked, back);
  EXPECT_EQ(back.color_from_depth.rotation, pose.rotation);
  EXPECT_EQ(back.color_from_depth.translation, pose.translation);
  EXPECT_EQ(back.rgbd_color, color);
  EXPECT_EQ(back.rgbd_depth, depth);
  EXPECT_EQ(back.region, region);
  for (int y = region.y; y < region.bottom(); ++y) {
    for (int x = region.x; x < region.right(); ++x) {
      ASSERT_EQ(back.region.keeps(x, y), region.keeps(x, y)) << x << ' ' << y;
    }
  }
  EXPECT_FALSE(back.options.smooth_depth);
  EXPECT_TRUE(back.options.snap_edges);
  EXPECT_EQ(back.options.discontinuity_threshold_m, 0.07);
  EXPECT_TRUE(back.coding.raw);
  EXPECT_EQ(back.coding.jpeg_quality, 80);
  EXPECT_EQ(back.coding.depth_unit_m, 2e-4);
}

std::vector<std::uint8_t> answer_with(RemoteLayer layer, const LayerCoding& coding) {
  std::vector<std::uint8_t> bytes;
  write_answer({}, layer, coding, bytes);
  return bytes;
}

RemoteLayer sent_and_read(const RemoteLayer& sent, const LayerCoding& coding) {
  const auto bytes = answer_with(sent, coding);
  auto message = open_answer(bytes);
  RemoteLayer back;
  back.region = sent.region;
  read(message.rest, back);
  return back;
}

TEST(NodeMessages, ALayerWithoutLossIsReadBitForBit) {
  const RemoteLayer sent = random_layer({4, 6, 40, 32});
  for (const LayerCoding& coding : {LayerCoding{false, 0, 0}, LayerCoding{true}}) {
    const RemoteLayer back = sent_and_read(sent, coding);
    EXPECT_EQ(back.inverse_z, sent.inverse_z);
    EXPECT_EQ(back.resolution, sent.resolution);
    for (std::size_t i = 0; i < sent.color.size(); ++i) {
      if (sent.inverse_z.data()[i] == 0) continue;
      ASSERT_EQ(back.color.data()[i], sent.color.data()[i]) << i;
    }
  }
}

TEST(NodeMessages, ALayersDepthIsRoundedToItsSteps) {
  const RemoteLayer sent = random_layer({4, 6, 40, 32});
  for (const double step_m : {2e-4, 1e-6}) {
    const RemoteLayer back = sent_and_read(sent, {false, 95, step_m});
    // 7.2 m are more than 65534 small steps.
    const double most_m = step_m > 1e-5 ? step_m / 2 : 6e-5;
    for (std::size_t i = 0; i < sent.inverse_z.size(); ++i) {
      const float a = sent.inverse_z.data()[i];
      const float b = back.inverse_z.data()[i];
      ASSERT_EQ(a == 0, b == 0) << i;
      if (a == 0) continue;
      ASSERT_NEAR(1 / a, 1 / b, 1.05 * most_m) << i;
    }
    ASSERT_EQ(back.resolution.size(), sent.resolution.size());
    for (std::size_t i = 0; i < sent.resolution.size(); ++i) {
      EXPECT_NEAR(back.resolution.data()[i], sent.resolution.data()[i], 1.5e-4);
      EXPECT_EQ(back.resolution.data()[i] == 0, sent.resolution.data()[i] == 0);
    }
  }
}

// 1 / z of a plane is even, but for the rounding of its numbers: a byte a pixel, not four.
TEST(NodeMessages, SurfacesWithoutLossAreSmall) {
  Image<float> plane(200, 100);
  for (int y = 0; y < plane.height(); ++y) {
    for (int x = 0; x < plane.width(); ++x) {
      plane(x, y) = 0.7F + 1e-4F * static_cast<float>(x) + 3e-4F * static_cast<float>(y);
    }
  }
  std::vector<std::uint8_t> bytes;
  compress_exactly(plane, bytes);
  // But for the first row and column, of which less is known.
  EXPECT_LT(bytes.size(), plane.size() + std::size_t{2} * (200 + 100));
  Image<float> back(plane.width(), plane.height());
  decompress_exactly(bytes, 1, back);
  EXPECT_EQ(back, plane);
  EXPECT_THROW(decompress_exactly(bytes, 0.7F, back), Error);
}

TEST(NodeMessages, RawNumbersThatAreNoneAreRefused) {
  for (const float value : {-1.F, 2000.F, std::nanf(""), 1e-9F}) {
    RemoteLayer sent = random_layer({4, 6, 40, 32});
    sent.inverse_z(3, 5) = value;
    EXPECT_THROW(sent_and_read(sent, {true}), Error) << value;
  }
}

TEST(NodeMessages, RawLayersOfAnotherSizeAreRefused) {
  const auto bytes = answer_with(random_layer({4, 6, 40, 32}), {true});
  auto message = open_answer(bytes);
  RemoteLayer back;
  back.region = {4, 6, 48, 32};
  EXPECT_EQ(error_of([&] { read(message.rest, back); }),
            "expected the pixels of the region that was asked for");
}

TEST(NodeMessages, RawLayersThatAreTooLargeForAMessageAreCompressed) {
  RemoteLayer sent;
  sent.region = {0, 0, 2400, 1600};
  sent.color = Image<Bgr>(2400, 1600, {90, 100, 110});
  sent.inverse_z = Image<float>(2400, 1600, 0.5F);
  sent.resolution = Image<float>(300, 200, 1.F);
  EXPECT_LT(answer_with(sent, {true}).size(), 4'000'000U);
  const RemoteLayer back = sent_and_read(sent, {true});
  EXPECT_NEAR(back.inverse_z(1200, 800), 0.5, 1e-4);
  EXPECT_NEAR(back.color(1200, 800).g, 100, 2);
}

class NodeGlance : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(RoundedAndExact, NodeGlance, ::testing::Bool());

TEST_P(NodeGlance, IsReadAsItWasWritten) {
  GlanceQuestion asked = question();
  asked.wishes.exact = GetParam();
  RgbdFrame images;
  std::mt19937 random(4);
  std::uniform_int_distribution<int> any(0, 255);
  images.color.own().resize(64, 48);
  for (Bgr& c : images.color.own()) {
    c = {static_cast<std::uint8_t>(any(random)), static_cast<std::uint8_t>(any(random)),
         static_cast<std::uint8_t>(any(random))};
  }
  images.depth.own().resize(40, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 40; ++x) {
      images.depth.own()(x, y) = static_cast<std::uint16_t>(any(random) < 20 ? 0 : 4000 + x);
    }
  }
  images.color_stamp_s = 3;
  images.depth_stamp_s = 3.001;
  Glance sent;
  GlanceMaker(asked.camera, asked.wishes).make(images, sent);
  ASSERT_GT(sent.points.size(), 20U);
  sent.markers.push_back({5, {{{1.25, 2}, {3, 4}, {5, 6}, {7, 8.5}}}});
  sent.depth_parts.push_back({2, 3, 9, 7});
  const auto bytes = write_answer({}, sent, asked);
  auto message = open_answer(bytes);
  Glance back;
  read(message.rest, asked, back);
  EXPECT_EQ(back.color_stamp_s, 3);
  EXPECT_EQ(back.depth_stamp_s, 3.001);
  EXPECT_EQ(back.depth, sent.depth);
  ASSERT_EQ(back.markers.size(), 1U);
  EXPECT_EQ(back.markers[0].corners, sent.markers[0].corners);
  ASSERT_EQ(back.points.size(), sent.points.size());
  std::size_t colored = 0;
  for (std::size_t i = 0; i < sent.points.size(); ++i) {
    const GlancePoint& a = sent.points[i];
    const GlancePoint& b = back.points[i];
    ASSERT_EQ(a.column, b.column);
    ASSERT_EQ(a.row, b.row);
    ASSERT_EQ(a.has_color, b.has_color);
    EXPECT_EQ(images.depth(b.column, b.row), back.depth(b.column, b.row));
    if (!a.has_color) continue;
    ++colored;
    EXPECT_EQ(a.color, b.color);
    EXPECT_EQ(a.even, b.even);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(a.brightness[k] < 0, b.brightness[k] < 0);
      EXPECT_NEAR(a.brightness[k], b.brightness[k], asked.wishes.exact ? 0 : 1. / 32);
    }
  }
  EXPECT_GT(colored, 10U);
}

// Cut off anywhere, or with any byte changed, a message is refused or read; nothing else happens.
TEST(NodeMessages, BrokenOnesAreRefused) {
  const GlanceQuestion asked = question();
  const RigidTransform pose;
  const Mask color = random_mask(64, 48, 1);
  const Mask depth = random_mask(40, 32, 2);
  const TiledRegion region(Rect{3, 5, 80, 50});
  const Options options;
  const RemoteLayer layer = random_layer(region);
  const auto read_question = [&](const std::vector<std::uint8_t>& bytes) {
    auto message = open_question(bytes);
    LayerQuestion read_one;
    read(message.rest, asked, read_one);
  };
  const auto read_answer = [&](const std::vector<std::uint8_t>& bytes) {
    auto message = open_answer(bytes);
    RemoteLayer read_one;
    read_one.region = {region.x, region.y, region.width, region.height};
    read(message.rest, read_one);
  };
  const auto try_all = [](const std::vector<std::uint8_t>& whole, const auto& read_one) {
    ASSERT_NO_THROW(read_one(whole));
    int refused = 0;
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 300) {
      EXPECT_THROW(read_one({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}),
                   Error)
          << size;
    }
    std::mt19937 random(1);
    for (int i = 0; i < 300; ++i) {
      auto changed = whole;
      changed[random() % changed.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
      try {
        read_one(changed);
      } catch (const Error&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 0);
  };
  try_all(write_question(head, {pose, color, depth, region, options}, {false, 80, 2e-4}),
          read_question);
  for (const LayerCoding& coding :
       {LayerCoding{false, 0, 1e-4}, LayerCoding{false, 0, 0}, LayerCoding{true}}) {
    try_all(answer_with(layer, coding), read_answer);
  }
}

TEST(NodeMessages, SizesAreBounded) {
  GlanceQuestion large = question();
  large.user.width = 8000;
  large.user.height = 8000;
  const auto bytes = write_question(head, large);
  EXPECT_EQ(error_of([&] {
              auto message = open_question(bytes);
              GlanceQuestion back;
              read(message.rest, back);
            }),
            "expected a user's picture of at most 10 million pixels");
}

}  // namespace
}  // namespace diminish
