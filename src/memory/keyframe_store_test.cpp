#include "memory/keyframe_store.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

std::shared_ptr<Keyframe> keyframe_of(const KeyframeGrid& grid, const Intrinsics& color,
                                      double x_m) {
  auto made = std::make_shared<Keyframe>();
  Keyframe& keyframe = *made;
  keyframe.color_from_world.translation.x() = -x_m;
  keyframe.picture.resize(color.width, color.height);
  keyframe.doubt.resize(grid.intrinsics().width, grid.intrinsics().height, 0);
  keyframe.depth.resize(grid.intrinsics().width, grid.intrinsics().height, 4000);  // 2 m
  return made;
}

Rig rig_of(const Intrinsics& color) {
  Rig rig;
  rig.color = color;
  return rig;
}

// Of an hour and a half.
TEST(KeyframeStore, StaysSmallHoweverManyAreAdded) {
  const Intrinsics color{64, 48, 50, 50, 31.5, 23.5, {}};
  const KeyframeGrid grid(color);
  KeyframeStore store(rig_of(color), grid);
  store.add(keyframe_of(grid, color, 0));
  const std::size_t one = store.bytes();
  for (int i = 0; i < 5000; ++i) {
    store.add(keyframe_of(grid, color, 3 * std::sin(0.1 * i)));
    ASSERT_LE(store.size(), KeyframeStore::most_keyframes);
    ASSERT_LE(store.bytes(), KeyframeStore::most_keyframes * one * 11 / 10);
  }
  EXPECT_EQ(store.size(), KeyframeStore::most_keyframes);
}

TEST(KeyframeStore, HoldsFewerOfLargePictures) {
  const Intrinsics color{8000, 6000, 5000, 5000, 3999.5, 2999.5, {}};
  const KeyframeGrid grid(color);
  KeyframeStore store(rig_of(color), grid);
  const std::size_t one = keyframe_of(grid, color, 0)->bytes();
  ASSERT_GT(one, KeyframeStore::most_bytes / 2);
  for (int i = 0; i < 4; ++i) store.add(keyframe_of(grid, color, i));
  EXPECT_LE(store.size(), 2U) << "two at least: one to compare with";
}

TEST(KeyframeStore, KeepsWhatNoOtherShows) {
  const Intrinsics color{64, 48, 50, 50, 31.5, 23.5, {}};
  const KeyframeGrid grid(color);
  KeyframeStore store(rig_of(color), grid);
  store.add(keyframe_of(grid, color, 50));  // far away from all others
  for (int i = 0; i < 100; ++i) store.add(keyframe_of(grid, color, 0.01 * i));
  EXPECT_EQ(store.all().front()->color_from_world.translation.x(), -50);
}

}  // namespace
}  // namespace diminish
