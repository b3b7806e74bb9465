#include "core/tasks.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace diminish {
namespace {

TEST(Tasks, EachIsDoneOnce) {
  for (const std::size_t count : {0U, 1U, 2U, 7U, 100U}) {
    std::vector<std::atomic<int>> times(count);
    for_tasks(count, [&](std::size_t i) { ++times[i]; });
    for (const auto& time : times) EXPECT_EQ(time, 1);
  }
}

TEST(Tasks, BothAreDone) {
  int first = 0;
  int second = 0;
  do_all([&] { ++first; }, [&] { ++second; });
  EXPECT_EQ(first, 1);
  EXPECT_EQ(second, 1);
}

/// A clock that stands still but for what is said to take time.
std::int64_t now_ns = 0;
std::int64_t clock_ns() {
  return now_ns;
}
void take(std::int64_t ns) {
  now_ns += ns;
}

class Tracing : public ::testing::Test {
 protected:
  template <class Work>
  tracing::Cost cost_of(const Work& work) {
    tracing::Cost cost;
    oneapi::tbb::task_arena(1).execute([&] {
      tracing::start(clock_ns);
      const tracing::Measurement measurement;
      work();
      cost = measurement.cost();
      spans = tracing::stop();
    });
    return cost;
  }

  std::vector<tracing::Span> spans;
};

TEST_F(Tracing, TheSpanOfTasksIsTheLongestOnes) {
  const tracing::Cost cost = cost_of([] {
    take(10);
    for_tasks(3, [](std::size_t i) { take(i == 1 ? 5 : 2); });
    take(1);
  });
  EXPECT_EQ(cost.work_ns, 10 + 2 + 5 + 2 + 1);
  EXPECT_EQ(cost.span_ns, 10 + 5 + 1);
}

TEST_F(Tracing, TasksInTasksCountBySpan) {
  const tracing::Cost cost = cost_of([] {
    do_all([] { for_tasks(4, [](std::size_t) { take(3); }); },  // 12 of work, 3 of span
           [] {
             take(2);
             for_tasks(2, [](std::size_t i) { take(i == 0 ? 4 : 1); });
           });
  });
  EXPECT_EQ(cost.work_ns, 12 + 2 + 5);
  EXPECT_EQ(cost.span_ns, 6);
}

TEST_F(Tracing, TheLongestChainIsToldByScope) {
  const tracing::Cost cost = cost_of([] {
    {
      const tracing::Scope stage("poses");
      take(4);
      for_tasks(2, [](std::size_t i) { take(i == 0 ? 6 : 3); });
    }
    do_all(
        [] {
          const tracing::Scope stage("memory");
          take(5);
        },
        [] {
          take(1);
          const tracing::Scope stage("drawing");
          for_tasks(2, [](std::size_t) { take(8); });
        });
  });
  std::map<std::string, std::int64_t> ns;
  for (const tracing::Cost::Link& link : cost.chain) ns[link.name] = link.ns;
  EXPECT_EQ(ns["poses"], 4 + 6);
  EXPECT_EQ(ns["drawing"], 8);
  EXPECT_EQ(ns[""], 1);
  EXPECT_EQ(ns["memory"], 0) << "not on it";
  EXPECT_EQ(cost.span_ns, 10 + 9);
  EXPECT_EQ(cost.regions, 3);
  EXPECT_EQ(cost.tasks, 6);
}

TEST_F(Tracing, SpansBearTheNameOfTheScopeAround) {
  cost_of([] {
    const tracing::Scope stage("drawing");
    take(1);
    for_tasks(2, [](std::size_t) { take(3); });
  });
  ASSERT_EQ(spans.size(), 3U);
  std::set<int> parts;
  for (const tracing::Span& span : spans) {
    EXPECT_STREQ(span.name, "drawing");
    EXPECT_EQ(span.thread, 0);
    EXPECT_EQ(span.end_ns - span.begin_ns, span.part < 0 ? 7 : 3);
    parts.insert(span.part);
  }
  EXPECT_EQ(parts, (std::set<int>{-1, 0, 1}));
}

TEST_F(Tracing, NothingIsKeptWhileItIsOff) {
  for_tasks(4, [](std::size_t) { take(3); });
  tracing::start(clock_ns);
  EXPECT_TRUE(tracing::stop().empty());
}

}  // namespace
}  // namespace diminish
