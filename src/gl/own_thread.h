#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace diminish::gl {

/// A thread that does what others ask it to, one after the other, while they wait.
class OwnThread {
 public:
  OwnThread();
  ~OwnThread();
  OwnThread(const OwnThread&) = delete;
  OwnThread& operator=(const OwnThread&) = delete;

  /// Returns when `work` is done; what it throws is thrown here. Work may ask for more work. Cost:
  /// two switches of threads, a few tens of microseconds.
  template <class Work>
  void run(const Work& work) {
    run({[](const void* own) { (*static_cast<const Work*>(own))(); }, &work});
  }

 private:
  /// Somebody's work, without a copy of it.
  struct Task {
    void (*call)(const void* own) = nullptr;  ///< null: there is none
    const void* own = nullptr;
  };
  void run(const Task& task);
  void loop();

  std::mutex turn_;  ///< held by the caller whose work is being done
  std::mutex mutex_;
  std::condition_variable changed_;
  Task task_;
  std::exception_ptr error_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace diminish::gl
