#include "sink/shares.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

TEST(Shares, AddUpAndSayWhatIsTrulySeen) {
  // 200 pixels: 40 witnessed and 84 others seen now, 50 remembered, 12 seen without depth, 14
  // invented.
  const Shares shares = shares_of(200, 186, 40, 50, 12);
  EXPECT_DOUBLE_EQ(shares.seen + shares.remembered + shares.estimated + shares.invented, 1);
  EXPECT_EQ(
      to_text(shares),
      "truly seen 62 % (witnessed 20 %), remembered 25 %, seen without depth 6 %, invented 7 %");
  EXPECT_EQ(to_text(shares_of(8, 5, 0, 0, 0), 1), "truly seen 62.5 %, invented 37.5 %");
}

TEST(Shares, NothingOfNothing) {
  EXPECT_EQ(to_text(shares_of(0, 0, 0, 0, 0)), "truly seen 0 %, invented 0 %");
}

}  // namespace
}  // namespace diminish
