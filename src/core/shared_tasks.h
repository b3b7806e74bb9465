#pragma once

#include <atomic>
#include <cstddef>

namespace diminish {

/// How many threads may work on something at a time: those that began it, and helpers.
class ThreadBudget {
 public:
  /// Not more than the process's oneapi::tbb::global_control allows.
  explicit ThreadBudget(int most);

  int most() const { return most_; }
  int left() const { return most_ - working_; }

  /// The calling thread works within this budget, and is helped within it, until the scope ends.
  class Use {
   public:
    explicit Use(ThreadBudget& budget);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    ThreadBudget* before_;
  };

 private:
  int most_;
  std::atomic<int> working_ = 0;
};

/// Calls call(what, i) for each i below `count`, on the calling thread and on helpers that are
/// idle: threads of the process, one less than the largest budget, begun when they are first
/// wanted. The budget is the one in use, else what the caller's oneTBB arena allows. Throws what
/// the first of the tasks that failed threw, when all have ended. Allocates nothing.
///
/// Why not oneTBB's loops: a thread that waits there yields, and beside other programs each yield
/// gives a whole time slice away (Linux 6.18). Here it does tasks of its own tasks, spins for a
/// moment, then sleeps. So it never begins another frame's tasks either.
void share_tasks(std::size_t count, void (*call)(const void* what, std::size_t i),
                 const void* what);

}  // namespace diminish
