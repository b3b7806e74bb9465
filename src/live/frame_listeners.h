#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "diminish/live.h"

namespace diminish {

/// Functions that are called with every frame. Any thread may add or remove one.
class FrameListeners {
 public:
  using Call = std::function<void(const std::shared_ptr<const LiveFrame>&)>;

  /// Destroying the result removes `call`, and waits for it where it runs on another thread.
  std::shared_ptr<void> add(Call call) {
    auto listener = std::make_shared<Listener>();
    listener->call = std::move(call);
    const std::lock_guard lock(mutex_);
    listeners_.push_back(listener);
    return {listener.get(), [listener](void*) {
              const std::lock_guard running(listener->mutex);
              listener->is_removed = true;
            }};
  }

  /// Not from two threads at once.
  void call(const std::shared_ptr<const LiveFrame>& frame) {
    {
      const std::lock_guard lock(mutex_);
      std::erase_if(listeners_, [](const auto& listener) {
        const std::unique_lock running(listener->mutex, std::try_to_lock);
        return running && listener->is_removed;
      });
      called_ = listeners_;
    }
    for (const auto& listener : called_) {
      const std::lock_guard running(listener->mutex);
      if (!listener->is_removed) listener->call(frame);
    }
    called_.clear();
  }

 private:
  struct Listener {
    std::recursive_mutex mutex;  ///< held while it is called; it may remove itself
    Call call;
    bool is_removed = false;
  };

  std::mutex mutex_;
  std::vector<std::shared_ptr<Listener>> listeners_;
  std::vector<std::shared_ptr<Listener>>
      called_;  ///< without the mutex, so that one may add others
};

}  // namespace diminish
