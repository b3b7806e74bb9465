#include "core/shared_tasks.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/thread_name.h"

namespace diminish {
namespace {

/// The tasks of one call of share_tasks, on the stack of the thread that called: their owner.
struct Region {
  std::size_t count;
  void (*call)(const void* what, std::size_t i);
  const void* what;
  ThreadBudget& budget;
  Region* around;  ///< one of whose tasks shares these; null: none
  std::atomic<std::size_t> next = 0;
  std::atomic<int> helpers = 0;  ///< who are at work; written under the crew's mutex

  // Guarded by the crew's mutex.
  Region* older = nullptr;
  Region* newer = nullptr;
  std::condition_variable* sleeper = nullptr;  ///< the owner's, while it sleeps
  std::size_t failed = 0;                      ///< the first task that threw
  std::exception_ptr error;

  bool has_more() const { return next.load(std::memory_order_relaxed) < count; }
  bool is_within(const Region& other) const {
    const Region* region = this;
    while (region && region != &other) region = region->around;
    return region != nullptr;
  }
};

thread_local Region* current_region = nullptr;  ///< whose task this thread does
thread_local ThreadBudget* current_budget = nullptr;

void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb");
#endif
}

/// Waits for what a thread on another core is about to do, without sleeping. False if it has not
/// come after a while. Where this core was taken away meanwhile, other programs want it: for some
/// time from then on, waits are short.
template <class Is>
bool spin_until(const Is& is) {
  using std::chrono::steady_clock;
  constexpr auto usual_wait = std::chrono::microseconds(100);
  constexpr auto short_wait = std::chrono::microseconds(10);
  constexpr auto taken_away = std::chrono::microseconds(100);
  constexpr auto remembered = std::chrono::milliseconds(100);
  thread_local steady_clock::time_point calm_at;
  const auto begin = steady_clock::now();
  const auto end = begin + (begin < calm_at ? short_wait : usual_wait);
  for (auto last = begin;;) {
    for (int k = 0; k < 16; ++k) {
      if (is()) return true;
      relax();
    }
    const auto now = steady_clock::now();
    if (now - last > taken_away) {
      calm_at = now + remembered;
      return is();
    }
    if (now > end) return false;
    last = now;
  }
}

constexpr auto always = [] { return true; };

/// The helpers of a process, and the regions that they may help with.
class Crew {
 public:
  /// Begins threads until there are `helpers`, or as many as the system lets it have.
  void open(Region& region, int helpers) {
    {
      const std::lock_guard lock(mutex_);
      begin_threads(helpers);
      region.older = newest_;
      (newest_ ? newest_->newer : oldest_) = &region;
      newest_ = &region;
      ++opened_;
      for (Region* outer = region.around; outer; outer = outer->around) {
        if (outer->sleeper) outer->sleeper->notify_one();
      }
      if (region.budget.left() <= 0) return;
      ++offers_;
      if (sleeping_ == 0) return;
    }
    // It wakes the next: the owner has better things to do.
    offered_.notify_one();
  }

  /// All that nobody else does.
  void do_tasks(Region& region) { do_tasks(region, always); }

  /// Waits until no helper is at work in it.
  void close(Region& region) {
    std::unique_lock lock(mutex_);
    while (region.helpers > 0) {
      const unsigned opened = opened_;
      if (Region* inner = find([&](const Region& any) { return any.is_within(region); })) {
        help(*inner, always, lock);
        continue;
      }
      lock.unlock();
      const bool has_come = spin_until([&] { return region.helpers == 0 || opened_ != opened; });
      lock.lock();
      if (has_come || region.helpers == 0 || opened_ != opened) continue;
      thread_local std::condition_variable changed;
      region.sleeper = &changed;
      changed.wait(lock);
      region.sleeper = nullptr;
    }
    (region.older ? region.older->newer : oldest_) = region.newer;
    (region.newer ? region.newer->older : newest_) = region.older;
  }

  // Around a fork, so that the child finds all that the mutex guards in order.
  void before_fork() { mutex_.lock(); }
  void after_fork() { mutex_.unlock(); }
  void after_fork_in_child() {
    sleeping_ = 0;  // nobody is there to be woken
    mutex_.unlock();
  }

  void end() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    offered_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  template <class Is>
  Region* find(const Is& is) const {
    Region* region = oldest_;
    while (region && !(region->has_more() && is(*region))) region = region->newer;
    return region;
  }

  /// Does tasks while go_on(). Throws nothing.
  template <class GoOn>
  void do_tasks(Region& region, const GoOn& go_on) {
    Region* const before = std::exchange(current_region, &region);
    while (go_on()) {
      const std::size_t i = region.next.fetch_add(1, std::memory_order_relaxed);
      if (i >= region.count) break;
      try {
        region.call(region.what, i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!region.error || i < region.failed) {
          region.error = std::current_exception();
          region.failed = i;
        }
      }
    }
    current_region = before;
  }

  template <class GoOn>
  void help(Region& region, const GoOn& go_on, std::unique_lock<std::mutex>& lock) {
    ++region.helpers;
    lock.unlock();
    do_tasks(region, go_on);
    lock.lock();
    // From here on its owner, too, needs the mutex to go on.
    if (--region.helpers == 0 && region.sleeper) region.sleeper->notify_one();
  }

  void begin_threads(int wanted) {
    try {
      while (static_cast<int>(threads_.size()) < wanted) threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
      // The others do it, a little later.
    }
  }

  void work() {
    name_this_thread("helper");
    std::unique_lock lock(mutex_);
    while (!ends_) {
      const unsigned offers = offers_;
      if (Region* region = find([](const Region& any) { return any.budget.left() > 0; })) {
        ThreadBudget& budget = region->budget;
        const ThreadBudget::Use use(budget);
        if (sleeping_ > 0 && budget.left() > 0 && region->has_more()) offered_.notify_one();
        // For threads that come later it makes room.
        const auto has_room = [&budget] { return budget.left() >= 0; };
        help(*region, has_room, lock);
        continue;
      }
      lock.unlock();
      const bool has_come = spin_until([&] { return offers_ != offers; });
      lock.lock();
      if (has_come || offers_ != offers || ends_) continue;
      ++sleeping_;
      offered_.wait(lock);
      --sleeping_;
    }
  }

  std::mutex mutex_;
  std::condition_variable offered_;
  // Counts of regions so far, written under the mutex.
  std::atomic<unsigned> opened_ = 0;
  std::atomic<unsigned> offers_ = 0;  ///< with some budget left
  std::size_t sleeping_ = 0;
  bool ends_ = false;
  Region* oldest_ = nullptr;
  Region* newest_ = nullptr;
  std::vector<std::thread> threads_;
};

/// Ends the crew with the process, or with the library. A forked process has no helpers, since
/// threads are not forked: it does its tasks alone, and must not wait for them at its end.
class CrewOfProcess {
 public:
  CrewOfProcess();
  ~CrewOfProcess() {
    if (getpid() != process_) return;
    crew_->end();
    delete crew_;
  }
  Crew& crew() { return *crew_; }

 private:
  pid_t process_ = getpid();
  Crew* crew_ = new Crew;
};

Crew& crew() {
  static CrewOfProcess the_crew;
  return the_crew.crew();
}

CrewOfProcess::CrewOfProcess() {
  pthread_atfork([] { diminish::crew().before_fork(); }, [] { diminish::crew().after_fork(); },
                 [] { diminish::crew().after_fork_in_child(); });
}

void share(std::size_t count, void (*call)(const void*, std::size_t), const void* what) {
  if (current_budget->most() <= 1) {
    for (std::size_t i = 0; i < count; ++i) call(what, i);
    return;
  }
  Region region{count, call, what, *current_budget, current_region};
  crew().open(region, current_budget->most() - 1);
  crew().do_tasks(region);
  crew().close(region);
  if (region.error) std::rethrow_exception(region.error);
}

}  // namespace

ThreadBudget::ThreadBudget(int most) {
  using oneapi::tbb::global_control;
  const auto allowed = global_control::active_value(global_control::max_allowed_parallelism);
  most_ = std::min(most, static_cast<int>(allowed));
}

ThreadBudget::Use::Use(ThreadBudget& budget) : before_(std::exchange(current_budget, &budget)) {
  ++budget.working_;
}

ThreadBudget::Use::~Use() {
  --current_budget->working_;
  current_budget = before_;
}

void share_tasks(std::size_t count, void (*call)(const void*, std::size_t), const void* what) {
  if (count == 0) return;
  if (current_budget) return share(count, call, what);
  ThreadBudget budget(oneapi::tbb::this_task_arena::max_concurrency());
  const ThreadBudget::Use use(budget);
  share(count, call, what);
}

}  // namespace diminish
