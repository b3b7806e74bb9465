#include "sink/distribution.h"

#include <gtest/gtest.h>

#include <numeric>

namespace diminish {
namespace {

TEST(Distribution, PercentilesAreNearestRanks) {
  std::vector<double> values(200);
  std::iota(values.rbegin(), values.rend(), 1.0);  // 200, ..., 1
  const Distribution d = distribution_of(values);
  EXPECT_EQ(d.least, 1);
  EXPECT_EQ(d.most, 200);
  EXPECT_EQ(d.average, 100.5);
  EXPECT_EQ(d.p50, 100);
  EXPECT_EQ(d.p95, 190);
  EXPECT_EQ(d.p99, 198);
}

TEST(Distribution, OfOneValueIsThatValue) {
  const Distribution d = distribution_of({7});
  for (const double value : {d.average, d.least, d.most, d.p50, d.p95, d.p99}) EXPECT_EQ(value, 7);
}

TEST(Distribution, OfNothingIsZero) {
  EXPECT_EQ(distribution_of({}).p99, 0);
}

}  // namespace
}  // namespace diminish
