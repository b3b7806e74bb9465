#include "detect/segment/segmentation.h"

#include <gtest/gtest.h>

#include <random>

#include "mask_overlap.h"
#include "onnx_model.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

constexpr int image_width = 480;
constexpr int image_height = 360;

/// A red square with a pattern on it that moves over a patterned wall.
class SegmentationTest : public ::testing::Test {
 protected:
  SegmentationTest() {
    testing::OnnxModel::write(folder.path() / "m.onnx", {{1, -0.5F, -0.5F}}, {0}, 96, 72);
    settings.model = folder.path() / "m.onnx";
    settings.width = 96;
    settings.height = 72;
    settings.threshold = 0.2;
  }

  static Rect square(int frame) { return {100 + 6 * frame, 120 + 3 * frame, 120, 110}; }

  static Image<Bgr> picture(int frame, int noise = 0, unsigned seed = 0) {
    Image<Bgr> picture(image_width, image_height);
    std::mt19937 random(seed);
    const Rect object = square(frame);
    for (int y = 0; y < image_height; ++y) {
      for (int x = 0; x < image_width; ++x) {
        const bool on = contains(object, x, y);
        const int u = on ? x - object.x : x;
        const int v = on ? y - object.y : y;
        const double wave = std::sin(u * 0.21) * std::cos(v * 0.17) + std::sin(u * 0.05 + v * 0.07);
        const int level = 100 + static_cast<int>(30 * wave);
        const auto jitter = [&] {
          return noise == 0 ? 0 : static_cast<int>(random() % (2 * noise + 1)) - noise;
        };
        const auto bounded = [&](int value) {
          return static_cast<std::uint8_t>(std::clamp(value + jitter(), 0, 255));
        };
        picture.row(y)[x] = on ? Bgr{bounded(level / 3), bounded(level / 3), bounded(level + 100)}
                               : Bgr{bounded(level), bounded(level), bounded(level)};
      }
    }
    return picture;
  }
  static bool contains(const Rect& rect, int x, int y) {
    return x >= rect.x && x < rect.x + rect.width && y >= rect.y && y < rect.y + rect.height;
  }

  std::unique_ptr<Segmentation> make() const {
    return std::make_unique<Segmentation>(settings, Config::parse("name: red", "s.yaml"),
                                          cv::Size(image_width, image_height));
  }
  static Mask truth(int frame) {
    Mask mask(image_width, image_height);
    mask.fill(square(frame), 255);
    return mask;
  }
  static Mask segment(Segmentation& network, const Image<Bgr>& picture, int frame) {
    Mask mask(image_width, image_height);
    network.segment(picture, frame / 30., mask);
    return mask;
  }

  TemporaryFolder folder;
  OnnxSettings settings;
};

TEST_F(SegmentationTest, AnswersAreCarriedToTheNewestPicture) {
  settings.every = 4;
  const auto network = make();
  for (int frame = 0; frame < 20; ++frame) {
    const Mask found = segment(*network, picture(frame), frame);
    // Not carried, the oldest answers, of seven pictures ago, would have an overlap of .4.
    EXPECT_GT(intersection_over_union(found, truth(frame)), 0.85) << frame;
  }
}

TEST_F(SegmentationTest, AnswersAreTakenAfterTheSameNumberOfPictures) {
  settings.every = 3;
  settings.steady = 0.3;
  const auto first = make();
  const auto second = make();
  for (int frame = 0; frame < 12; ++frame) {
    const Image<Bgr> shown = picture(frame, 10, static_cast<unsigned>(frame));
    const Mask found = segment(*first, shown, frame);
    if (frame == 6) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(found, segment(*second, shown, frame)) << frame;
  }
}

TEST_F(SegmentationTest, ACutBeginsAnew) {
  settings.every = 10;
  const auto network = make();
  segment(*network, picture(0), 0);
  segment(*network, picture(1), 1);
  // Another place, much later; and the first again: a recording that is replayed.
  EXPECT_GT(intersection_over_union(segment(*network, picture(25), 60), truth(25)), 0.9);
  EXPECT_GT(intersection_over_union(segment(*network, picture(0), 0), truth(0)), 0.9);
}

/// The share of pixels that change from picture to picture of a scene that stands still, where
/// noise decides.
TEST_F(SegmentationTest, SteadyAnswersFlickerLess) {
  settings.threshold = 0.42;
  const auto flicker = [&](double steady) {
    settings.steady = steady;
    const auto network = make();
    Mask before;
    int changed = 0;
    for (int frame = 0; frame < 12; ++frame) {
      const Mask found = segment(*network, picture(0, 90, static_cast<unsigned>(frame) + 1), frame);
      if (frame > 3) {
        for (int y = 0; y < image_height; ++y) {
          for (int x = 0; x < image_width; ++x)
            changed += found.row(y)[x] != before.row(y)[x] ? 1 : 0;
        }
      }
      before = found;
    }
    return changed;
  };
  const int alone = flicker(0);
  EXPECT_GT(alone, 1000);
  EXPECT_LT(flicker(0.7), alone / 2);
}

}  // namespace
}  // namespace diminish
