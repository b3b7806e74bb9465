#include "gl/own_thread.h"

#include <utility>

#include "core/thread_name.h"

namespace diminish::gl {

OwnThread::OwnThread() : thread_([this] { loop(); }) {}

OwnThread::~OwnThread() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void OwnThread::run(const Task& task) {
  if (std::this_thread::get_id() == thread_.get_id()) return task.call(task.own);
  const std::lock_guard turn(turn_);
  std::unique_lock lock(mutex_);
  task_ = task;
  changed_.notify_all();
  changed_.wait(lock, [&] { return task_.call == nullptr; });
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

void OwnThread::loop() {
  name_this_thread("gl");
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return task_.call != nullptr || ends_; });
    if (ends_) return;
    const Task task = task_;
    lock.unlock();
    std::exception_ptr error;
    try {
      task.call(task.own);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    error_ = error;
    task_ = {};
    changed_.notify_all();
  }
}

}  // namespace diminish::gl
