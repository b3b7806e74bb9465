#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace diminish::tracing {

// Who did what, when, and how much of it could be done at the same time: for `diminish bench`.
// While it is off, a scope costs the reading of a flag. The stages and core/tasks.h call it; one
// trace at a time.

using Clock = std::int64_t (*)();  ///< nanoseconds

/// One thread's time with something.
struct Span {
  const char* name;
  int part;  ///< the number of a task; -1: not one of several
  int thread;
  std::int64_t begin_ns, end_ns;
};

/// What a task takes on one thread, and on as many as can help: its longest chain of parts that
/// wait for one another. True if all threads are idle otherwise: measured on one thread.
struct Cost {
  std::int64_t work_ns = 0, span_ns = 0;
  int regions = 0;  ///< in which threads share tasks
  int tasks = 0;
  struct Link {
    const char* name;  ///< of the scope, the innermost
    std::int64_t ns;
  };
  std::vector<Link> chain;  ///< the longest, by name
};

std::int64_t steady_now_ns();
/// What the calling thread has computed: another program on its core does not add to it.
std::int64_t thread_now_ns();

/// Begins a trace of all threads.
void start(Clock clock = steady_now_ns);
/// Ends it. Spans are sorted by when they began.
std::vector<Span> stop();

namespace detail {
inline std::atomic<bool> on = false;
struct Chain {
  std::int64_t since_ns = 0;  ///< when its last region ended
  Cost cost;
};
}  // namespace detail

inline bool is_on() {
  return detail::on.load(std::memory_order_relaxed);
}

/// What the calling thread does from here on until the scope ends.
class Scope {
 public:
  explicit Scope(const char* name);
  ~Scope();
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;

 private:
  const char* name_ = nullptr;
  const char* name_before_ = nullptr;
  std::int64_t begin_ns_ = 0;
};

/// Measures what the calling thread does while it exists, with all that other threads do for it.
class Measurement {
 public:
  Measurement();
  ~Measurement();
  Measurement(const Measurement&) = delete;
  Measurement& operator=(const Measurement&) = delete;

  Cost cost() const;

 private:
  detail::Chain chain_;
  detail::Chain* before_ = nullptr;
};

/// Tasks that threads share, one of which waits for all.
class Region {
 public:
  explicit Region(std::size_t tasks);
  /// All tasks are done.
  ~Region();
  Region(const Region&) = delete;
  Region& operator=(const Region&) = delete;

  /// One of the tasks, on whichever thread.
  class Task {
   public:
    Task(Region& region, std::size_t index);
    ~Task();
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

   private:
    Region& region_;
    std::size_t index_;
    detail::Chain chain_;
    detail::Chain* before_ = nullptr;
    const char* name_before_ = nullptr;
    std::int64_t begin_ns_ = 0;
  };

 private:
  bool is_on_;
  detail::Chain* around_ = nullptr;
  const char* name_ = "";
  std::vector<Cost> costs_;
};

}  // namespace diminish::tracing
