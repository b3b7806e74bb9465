#include "bars/known_bars.h"

#include "bar_scene.h"

namespace diminish {
namespace {

class KnownBarsTest : public testing::BarScene {
 protected:
  /// What is found in a picture without edges.
  const std::vector<Bar>& find_known() {
    look_for_lines();
    known.recall(*seen->poses.color_from_world, *views, masks.color, recalled);
    search.find({{}, *views, planes, result.surfaces, masks.color, recalled});
    return search.bars();
  }
  void keep(const std::vector<Bar>& bars) {
    known.keep(*seen->poses.color_from_world, *views, bars);
  }

  KnownBars known;
  std::vector<Bar> recalled;
};

TEST_F(KnownBarsTest, OneIsFoundWhereItIsWithoutItsEdges) {
  look();
  EXPECT_TRUE(find_known().empty());
  keep(find());
  color_eye = {0.02, 0.05, 1.15};
  look();
  ASSERT_EQ(find_known().size(), 1U);
  expect_where_it_is(search.bars()[0]);
  keep(search.bars());
  color_eye = {0.08, -0.02, 1.25};
  look();
  ASSERT_EQ(find_known().size(), 1U);
  expect_where_it_is(search.bars()[0]);
}

TEST_F(KnownBarsTest, OneThatIsGoneIsNotFound) {
  look();
  known.recall(*seen->poses.color_from_world, views.emplace(seen->rig), masks.color, recalled);
  keep(find());
  scene.has_box = false;
  look();
  EXPECT_TRUE(find_known().empty());
  EXPECT_EQ(recalled.size(), 1U);
}

TEST_F(KnownBarsTest, IsForgottenOnceItIsNotFoundForHalfASecond) {
  look();
  keep(find());
  for (int i = 0; i < 15; ++i) {
    find_known();
    EXPECT_EQ(recalled.size(), 1U) << i;
    keep({});
  }
  find_known();
  keep({});
  find_known();
  EXPECT_TRUE(recalled.empty());
}

TEST_F(KnownBarsTest, PipelinesShareThem) {
  look();
  KnownBars other;
  other.share(known);
  keep(find());
  other.recall(*seen->poses.color_from_world, *views, masks.color, recalled);
  other.end_turn();
  EXPECT_EQ(recalled.size(), 1U);
  known.forget();
  other.recall(*seen->poses.color_from_world, *views, masks.color, recalled);
  EXPECT_TRUE(recalled.empty());
}

}  // namespace
}  // namespace diminish
