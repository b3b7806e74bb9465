#include "diminish/image.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

TEST(Image, KeepsItsMemoryWhenItShrinksAndGrowsBack) {
  Image<float> image(40, 30, 1.F);
  const float* memory = image.data();
  image.resize(10, 10);
  image.resize(40, 30);
  EXPECT_EQ(image.data(), memory);
}

TEST(Image, BoundingBoxHoldsAllPixelsAndNoEmptyRowOrColumn) {
  Mask mask(20, 10, 0);
  EXPECT_TRUE(bounding_box(mask).empty());
  mask(3, 4) = 255;
  mask(17, 9) = 1;
  EXPECT_EQ(bounding_box(mask), (Rect{3, 4, 15, 6}));
  EXPECT_EQ(bounding_box(mask, {1, 2, 17, 8}), (Rect{3, 4, 15, 6}));
  EXPECT_TRUE(bounding_box(mask, {0, 0, 3, 4}).empty());
  EXPECT_TRUE(bounding_box(mask, {}).empty());
  mask(0, 0) = 255;
  mask(19, 9) = 255;
  EXPECT_EQ(bounding_box(mask), mask.bounds());
  EXPECT_EQ(count_nonzero(mask, mask.bounds()), 4U);
  EXPECT_EQ(count_nonzero(mask, {3, 4, 1, 1}), 1U);
}

TEST(Rect, IntersectionOfRectanglesApartIsEmpty) {
  EXPECT_TRUE(intersect({0, 0, 5, 5}, {7, 0, 5, 5}).empty());
  EXPECT_EQ(intersect({0, 0, 5, 5}, {3, 4, 5, 5}), (Rect{3, 4, 2, 1}));
  EXPECT_EQ(grow({3, 4, 2, 1}, 2), (Rect{1, 2, 6, 5}));
}

}  // namespace
}  // namespace diminish
