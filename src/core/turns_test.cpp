#include "core/turns.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace diminish {
namespace {

TEST(Turns, ComeInOrderWhoeverIsFirst) {
  Turns turns;
  constexpr std::size_t count = 20;
  std::vector<std::size_t> order;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(turns.take(), i);
  for (std::size_t i = count; i-- > 0;) {
    threads.emplace_back([&, i] {
      // Every third one does not use its turn.
      if (i % 3 != 1) {
        turns.wait(i);
        order.push_back(i);
      }
      turns.end(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 3 != 1) expected.push_back(i);
  }
  EXPECT_EQ(order, expected);
}

}  // namespace
}  // namespace diminish
