#include "core/bounded_queue.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

namespace diminish {
namespace {

TEST(BoundedQueue, TakesNoMoreThanFit) {
  BoundedQueue<int> queue(2);
  EXPECT_TRUE(queue.offer(1));
  EXPECT_TRUE(queue.offer(2));
  EXPECT_FALSE(queue.offer(3));
  EXPECT_EQ(queue.take(), 1);
  EXPECT_TRUE(queue.offer(4));
  EXPECT_EQ(queue.take(), 2);
  EXPECT_EQ(queue.take(), 4);
}

TEST(BoundedQueue, GivesWhatWaitsAfterItIsClosedAndTakesNothingMore) {
  BoundedQueue<std::unique_ptr<int>> queue(2);
  EXPECT_TRUE(queue.offer(std::make_unique<int>(1)));
  queue.close();
  EXPECT_FALSE(queue.offer(std::make_unique<int>(2)));
  const auto item = queue.take();
  ASSERT_TRUE(item);
  EXPECT_EQ(**item, 1);
  EXPECT_FALSE(queue.take());
}

TEST(BoundedQueue, WakesWhoWaits) {
  BoundedQueue<int> queue(1);
  std::vector<int> taken;
  std::thread taker([&] {
    while (const std::optional<int> item = queue.take()) taken.push_back(*item);
  });
  std::vector<int> offered;
  for (int i = 0; i < 1000; ++i) {
    if (queue.offer(i)) offered.push_back(i);
  }
  queue.close();
  taker.join();
  EXPECT_EQ(taken, offered);
}

}  // namespace
}  // namespace diminish
