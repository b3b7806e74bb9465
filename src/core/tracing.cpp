#include "core/tracing.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <mutex>
#include <string_view>
#include <utility>

namespace diminish::tracing {
namespace {

using detail::Chain;

struct Recorder {
  std::mutex mutex;
  std::vector<Span> spans;
  int threads = 0;
  int trace = 0;  ///< its number: threads are counted anew in each
  Clock now_ns = steady_now_ns;
};

Recorder& recorder() {
  static Recorder the_recorder;
  return the_recorder;
}

struct ThisThread {
  int number = 0;
  int trace = -1;
  const char* name = "";
  Chain* chain = nullptr;
};
thread_local ThisThread this_thread;

void record(const char* name, int part, std::int64_t begin_ns, std::int64_t end_ns) {
  Recorder& all = recorder();
  const std::lock_guard lock(all.mutex);
  if (this_thread.trace != all.trace) {
    this_thread.trace = all.trace;
    this_thread.number = all.threads++;
  }
  all.spans.push_back({name, part, this_thread.number, begin_ns, end_ns});
}

void add_link(Cost& cost, const Cost::Link& added) {
  const auto same = std::find_if(cost.chain.begin(), cost.chain.end(), [&](const Cost::Link& link) {
    return std::string_view(link.name) == added.name;
  });
  if (same == cost.chain.end()) {
    cost.chain.push_back(added);
  } else {
    same->ns += added.ns;
  }
}

/// Adds what this thread has done since the chain's last region or change of name.
void close_segment(Chain& chain, std::int64_t now_ns) {
  const std::int64_t ns = now_ns - chain.since_ns;
  chain.cost.work_ns += ns;
  chain.cost.span_ns += ns;
  add_link(chain.cost, {this_thread.name, ns});
  chain.since_ns = now_ns;
}

}  // namespace

std::int64_t steady_now_ns() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

std::int64_t thread_now_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::chrono::nanoseconds(std::chrono::seconds(now.tv_sec)).count() + now.tv_nsec;
}

void start(Clock clock) {
  Recorder& all = recorder();
  const std::lock_guard lock(all.mutex);
  all.spans.clear();
  all.threads = 0;
  ++all.trace;
  all.now_ns = clock;
  detail::on = true;
}

std::vector<Span> stop() {
  detail::on = false;
  Recorder& all = recorder();
  const std::lock_guard lock(all.mutex);
  std::stable_sort(all.spans.begin(), all.spans.end(),
                   [](const Span& a, const Span& b) { return a.begin_ns < b.begin_ns; });
  return std::exchange(all.spans, {});
}

Scope::Scope(const char* name) {
  if (!is_on()) return;
  name_ = name;
  begin_ns_ = recorder().now_ns();
  if (this_thread.chain) close_segment(*this_thread.chain, begin_ns_);
  name_before_ = std::exchange(this_thread.name, name);
}

Scope::~Scope() {
  if (!name_) return;
  const std::int64_t end_ns = recorder().now_ns();
  if (this_thread.chain) close_segment(*this_thread.chain, end_ns);
  this_thread.name = name_before_;
  record(name_, -1, begin_ns_, end_ns);
}

Measurement::Measurement() {
  chain_.since_ns = recorder().now_ns();
  before_ = std::exchange(this_thread.chain, &chain_);
}

Measurement::~Measurement() {
  this_thread.chain = before_;
}

Cost Measurement::cost() const {
  Chain chain = chain_;
  close_segment(chain, recorder().now_ns());
  return chain.cost;
}

Region::Region(std::size_t tasks) : is_on_(tracing::is_on()) {
  if (!is_on_) return;
  name_ = this_thread.name;
  around_ = this_thread.chain;
  costs_.resize(tasks);
  if (around_) close_segment(*around_, recorder().now_ns());
}

Region::~Region() {
  if (!is_on_ || !around_ || costs_.empty()) return;
  Cost& cost = around_->cost;
  ++cost.regions;
  for (const Cost& task : costs_) {
    cost.work_ns += task.work_ns;
    cost.regions += task.regions;
    cost.tasks += 1 + task.tasks;
  }
  const Cost& longest =
      *std::max_element(costs_.begin(), costs_.end(),
                        [](const Cost& a, const Cost& b) { return a.span_ns < b.span_ns; });
  cost.span_ns += longest.span_ns;
  for (const Cost::Link& link : longest.chain) add_link(cost, link);
  around_->since_ns = recorder().now_ns();
}

Region::Task::Task(Region& region, std::size_t index) : region_(region), index_(index) {
  if (!region_.is_on_) return;
  begin_ns_ = recorder().now_ns();
  name_before_ = std::exchange(this_thread.name, region_.name_);
  chain_.since_ns = begin_ns_;
  before_ = std::exchange(this_thread.chain, &chain_);
}

Region::Task::~Task() {
  if (!region_.is_on_) return;
  const std::int64_t end_ns = recorder().now_ns();
  close_segment(chain_, end_ns);
  region_.costs_[index_] = chain_.cost;
  this_thread.chain = before_;
  this_thread.name = name_before_;
  record(region_.name_, static_cast<int>(index_), begin_ns_, end_ns);
}

}  // namespace diminish::tracing
