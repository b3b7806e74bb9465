#include "live/live_settings.h"

#include "diminish/error.h"

namespace diminish {

Options LiveSettings::options() const {
  const std::lock_guard lock(mutex_);
  return options_;
}

double LiveSettings::sync_tolerance_s() const {
  const std::lock_guard lock(mutex_);
  return options_.sync_tolerance_s;
}

void LiveSettings::set_options(const Options& options) {
  const std::lock_guard lock(mutex_);
  options_ = options;
  ++version_;
  problem_.clear();
}

double LiveSettings::budget_ms() const {
  const std::lock_guard lock(mutex_);
  return budget_ms_;
}

void LiveSettings::set_budget_ms(double budget_ms) {
  const std::lock_guard lock(mutex_);
  budget_ms_ = budget_ms;
}

// Without the mutex while the pipeline takes them: that may compile shaders.
void LiveSettings::apply(Pipeline& pipeline, std::size_t& version) {
  std::unique_lock lock(mutex_);
  if (version == version_) return;
  version = version_;
  const Options wanted = options_;
  const int level = ladder_.level();
  lock.unlock();
  try {
    pipeline.set_options(QualityLadder::simplified(wanted, level));
    lock.lock();
    last_good_ = wanted;
  } catch (const Error& error) {  // a backend that does not work here
    lock.lock();
    problem_ = error.what();
    const Options good = last_good_;
    if (version == version_) {
      options_ = good;
      version = ++version_;
    }
    lock.unlock();
    pipeline.set_options(QualityLadder::simplified(good, level));
  }
}

void LiveSettings::keep_budget(double frame_ms) {
  const std::lock_guard lock(mutex_);
  const int level = ladder_.level();
  if (ladder_.next_level(frame_ms, budget_ms_, options_) != level) ++version_;
}

void LiveSettings::describe(LiveStatus& status) const {
  const std::lock_guard lock(mutex_);
  status.budget_ms = budget_ms_;
  status.quality_level = ladder_.level();
  status.quality = QualityLadder::description(options_, ladder_.level());
  if (!problem_.empty()) status.problems.push_back(problem_);
}

}  // namespace diminish
