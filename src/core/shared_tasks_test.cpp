#include "core/shared_tasks.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/tasks.h"

namespace diminish {
namespace {

using namespace std::chrono_literals;

class SharedTasks : public ::testing::Test {
 protected:
  oneapi::tbb::global_control enough{oneapi::tbb::global_control::max_allowed_parallelism, 8};
};

/// How many threads are in a scope at a time, at most.
class Crowd {
 public:
  class Visit {
   public:
    explicit Visit(Crowd& crowd) : crowd_(crowd) {
      const int now = ++crowd_.now_;
      int most = crowd_.most_;
      while (now > most && !crowd_.most_.compare_exchange_weak(most, now)) {
      }
    }
    ~Visit() { --crowd_.now_; }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    Crowd& crowd_;
  };
  int most() const { return most_; }

 private:
  std::atomic<int> now_ = 0, most_ = 0;
};

/// The sum of 0 .. 19, by tasks in tasks in tasks.
int nested_sum() {
  std::atomic<int> sum = 0;
  do_all([&] { for_tasks(10, [&](std::size_t i) { sum += static_cast<int>(i); }); },
         [&] {
           for_tasks(2, [&](std::size_t half) {
             for_tasks(5, [&](std::size_t i) { sum += static_cast<int>(10 + 5 * half + i); });
           });
         });
  return sum;
}

TEST_F(SharedTasks, OfManyThreadsAtOnceAreAllDone) {
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> threads;
    threads.reserve(6);
    for (int k = 0; k < 6; ++k) {
      threads.emplace_back([&wrong, k] {
        ThreadBudget budget(1 + k);
        const ThreadBudget::Use use(budget);
        for (int i = 0; i < 300; ++i) wrong += nested_sum() != 190;
      });
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST_F(SharedTasks, AsManyThreadsAsTheBudgetHasWorkAtOnce) {
  for (const int most : {1, 2, 5}) {
    ThreadBudget budget(most);
    const ThreadBudget::Use use(budget);
    Crowd crowd;
    // Until so many are there: helpers may have been asleep.
    for (int round = 0; round < 500 && crowd.most() < most; ++round) {
      for_tasks(8, [&](std::size_t) {
        const Crowd::Visit visit(crowd);
        std::this_thread::sleep_for(1ms);
      });
    }
    EXPECT_EQ(crowd.most(), most);
  }
}

TEST_F(SharedTasks, ThoseWhoShareABudgetGetNoHelpersBeyondIt) {
  ThreadBudget budget(2);
  Crowd crowd;
  std::atomic<int> here = 0;
  const auto work = [&] {
    const ThreadBudget::Use use(budget);
    ++here;
    while (here < 2) std::this_thread::yield();
    for (int round = 0; round < 20; ++round) {
      for_tasks(4, [&](std::size_t) {
        const Crowd::Visit visit(crowd);
        std::this_thread::sleep_for(200us);
      });
    }
    --here;
    while (here > 0) std::this_thread::yield();
  };
  std::jthread other(work);
  work();
  EXPECT_LE(crowd.most(), 2);
}

TEST_F(SharedTasks, TheFirstErrorIsThrownWhenAllHaveEnded) {
  for (const int most : {1, 4}) {
    ThreadBudget budget(most);
    const ThreadBudget::Use use(budget);
    for (int round = 0; round < 50; ++round) {
      std::atomic<int> at_work = 0;
      std::string thrown;
      try {
        for_tasks(20, [&](std::size_t i) {
          ++at_work;
          if (i % 3 == 2) {
            --at_work;
            throw std::runtime_error(std::to_string(i));
          }
          std::this_thread::sleep_for(10us);
          --at_work;
        });
      } catch (const std::runtime_error& error) {
        thrown = error.what();
      }
      EXPECT_EQ(thrown, "2");
      EXPECT_EQ(at_work, 0);
    }
    EXPECT_EQ(nested_sum(), 190) << "goes on after it";
  }
}

// Those who came later take a helper's place only between its tasks, not within them.
TEST_F(SharedTasks, AreAllDoneWhereMoreThreadsComeThanTheBudgetHas) {
  ThreadBudget budget(2);
  std::atomic<int> wrong = 0;
  {
    std::vector<std::jthread> threads;
    threads.reserve(6);
    for (int k = 0; k < 4; ++k) {
      threads.emplace_back([&] {
        for (int i = 0; i < 300; ++i) {
          const ThreadBudget::Use use(budget);
          wrong += nested_sum() != 190;
        }
      });
    }
  }
  EXPECT_EQ(wrong, 0);
}

// It waits for a task that a helper has, while there are others that it does not wait for.
TEST_F(SharedTasks, AThreadThatWaitsBeginsNothingElse) {
  static thread_local bool is_owner = false;
  std::atomic<bool> ends = false;
  std::atomic<int> others_by_owner = 0;
  std::atomic<int> by_helper = 0;
  std::jthread other([&] {
    ThreadBudget budget(2);
    const ThreadBudget::Use use(budget);
    while (!ends) {
      for_tasks(50, [&](std::size_t) {
        if (is_owner) ++others_by_owner;
        std::this_thread::sleep_for(50us);
      });
    }
  });
  ThreadBudget budget(4);
  const ThreadBudget::Use use(budget);
  is_owner = true;
  for (int round = 0; round < 2000 && by_helper < 20; ++round) {
    for_tasks(4, [&](std::size_t) {
      if (!is_owner) ++by_helper;
      std::this_thread::sleep_for(is_owner ? 200us : 2ms);  // its owner spins, then sleeps
    });
  }
  is_owner = false;
  ends = true;
  EXPECT_GT(by_helper, 0);
  EXPECT_EQ(others_by_owner, 0);
}

TEST_F(SharedTasks, AreDoneInAForkedProcessWhichHasNoHelpers) {
  ThreadBudget budget(4);
  const ThreadBudget::Use use(budget);
  EXPECT_EQ(nested_sum(), 190);
  // Without a search for leaks, which would wait for locks that helpers held.
  EXPECT_EXIT(std::_Exit(nested_sum() == 190 ? 0 : 1), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace diminish
