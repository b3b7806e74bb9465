#pragma once

#include <memory>
#include <mutex>
#include <vector>

namespace diminish {

/// Frames or images whose memory is reused when nobody holds them any more, on whichever thread.
template <class Item>
class Pool {
 public:
  /// An item that reuses the memory of an earlier one (and is as that was left), or a new one.
  std::shared_ptr<Item> take() {
    std::unique_ptr<Item> item;
    {
      const std::lock_guard lock(shelf_->mutex);
      if (!shelf_->items.empty()) {
        item = std::move(shelf_->items.back());
        shelf_->items.pop_back();
      }
    }
    if (!item) item = std::make_unique<Item>();
    return {item.release(), [shelf = shelf_](Item* used) {
              std::unique_ptr<Item> owned(used);
              const std::lock_guard lock(shelf->mutex);
              if (shelf->items.size() < most_kept) shelf->items.push_back(std::move(owned));
            }};
  }

 private:
  static constexpr std::size_t most_kept = 4;
  struct Shelf {
    std::mutex mutex;
    std::vector<std::unique_ptr<Item>> items;
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace diminish
