#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "diminish/live.h"

namespace diminish {

/// Frames whose memory is reused when nobody holds them any more.
class FramePool {
 public:
  /// A frame that reuses the memory of an earlier one, or a new one.
  std::shared_ptr<LiveFrame> take() {
    std::unique_ptr<LiveFrame> frame;
    {
      const std::lock_guard lock(shelf_->mutex);
      if (!shelf_->frames.empty()) {
        frame = std::move(shelf_->frames.back());
        shelf_->frames.pop_back();
      }
    }
    if (!frame) frame = std::make_unique<LiveFrame>();
    return {frame.release(), [shelf = shelf_](LiveFrame* used) {
              std::unique_ptr<LiveFrame> owned(used);
              const std::lock_guard lock(shelf->mutex);
              if (shelf->frames.size() < most_kept) shelf->frames.push_back(std::move(owned));
            }};
  }

 private:
  static constexpr std::size_t most_kept = 4;
  struct Shelf {
    std::mutex mutex;
    std::vector<std::unique_ptr<LiveFrame>> frames;
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace diminish
