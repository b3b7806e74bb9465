#include <gtest/gtest.h>

#include <random>

#include "core/median_of_magnitudes.h"
#include "core/robust.h"

namespace diminish {
namespace {

TEST(MedianOfMagnitudes, IsTheMedian) {
  std::mt19937 random(1);
  for (const float spread : {0.F, 1e-30F, 1.F, 3.F}) {
    for (std::size_t count = 1; count < 300; count += 1 + count / 10) {
      std::vector<float> values(count);
      for (float& value : values) {
        value = std::abs(std::normal_distribution<float>(0, 20)(random)) * spread;
        if (random() % 7 == 0) value = std::round(value);  // some are equal
      }
      std::vector<float> same = values;
      ASSERT_EQ(median_of_magnitudes(values), median(same)) << count << " times " << spread;
    }
  }
}

}  // namespace
}  // namespace diminish
