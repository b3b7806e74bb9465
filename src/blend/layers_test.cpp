#include "blend/layers.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

class MergeLayers : public ::testing::Test {
 protected:
  MergeLayers() {
    for (Layer& layer : layers) layer.clear(10, 4, {0, 0, 10, 4});
    reconstruction.region = Rect{0, 0, 10, 4};
    reconstruction.color.resize(10, 4, {});
    reconstruction.depth_m.resize(10, 4, 0.F);
    reconstruction.source.resize(10, 4, 0);
  }

  void draw(std::size_t layer, int x, int y, float z) {
    layers[layer].depth_m(x, y) = z;
    layers[layer].color(x, y) = {static_cast<std::uint8_t>(100 * (layer + 1)), 0, 0, 255};
  }
  void merge() { merge_layers({&layers[0], &layers[1]}, 0.03F, reconstruction); }

  Layer layers[2];
  Reconstruction reconstruction;
};

// A centimetre of noise changes nothing: the whole surface comes from the camera that sees more.
TEST_F(MergeLayers, DoesNotSpeckleWhereSurfacesAgree) {
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 10; ++x) {
      if (x < 8) draw(0, x, y, 1.F + ((x + y) % 2 == 0 ? 0.01F : -0.01F));
      draw(1, x, y, 1.F);
    }
  }
  merge();
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 10; ++x) EXPECT_EQ(reconstruction.source(x, y), 2);
  }
}

TEST_F(MergeLayers, TheNearerOfTwoSurfacesHidesTheOther) {
  draw(0, 2, 1, 1.0F);
  draw(1, 2, 1, 1.1F);
  draw(0, 3, 1, 1.1F);
  draw(1, 3, 1, 1.0F);
  draw(1, 4, 1, 1.0F);
  merge();
  EXPECT_EQ(reconstruction.source(2, 1), 1);
  EXPECT_EQ(reconstruction.source(3, 1), 2);
  EXPECT_EQ(reconstruction.source(4, 1), 2);
  EXPECT_EQ(reconstruction.source(5, 1), 0);
  EXPECT_EQ(reconstruction.color(2, 1), (Bgra{100, 0, 0, 255}));
  EXPECT_FLOAT_EQ(reconstruction.depth_m(3, 1), 1.0F);
}

TEST_F(MergeLayers, ACameraThatTakesNoPartIsLeftOut) {
  draw(1, 2, 1, 1.0F);
  merge_layers({nullptr, &layers[1]}, 0.03F, reconstruction);
  EXPECT_EQ(reconstruction.source(2, 1), 2);
}

}  // namespace
}  // namespace diminish
