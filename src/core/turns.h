#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <set>

namespace diminish {

/// Lets several threads, each with a frame, do something one after the other, in the frames' order.
class Turns {
 public:
  /// The next turn. Every turn that is taken must be ended.
  std::size_t take() {
    const std::lock_guard lock(mutex_);
    return taken_++;
  }
  /// Waits until all turns before this one have ended.
  void wait(std::size_t turn) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return next_ == turn; });
  }
  void end(std::size_t turn) {
    {
      const std::lock_guard lock(mutex_);
      if (turn != next_) {
        ended_.insert(turn);
        return;
      }
      do ++next_;
      while (ended_.erase(next_) > 0);
    }
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t taken_ = 0;
  std::size_t next_ = 0;         ///< all before it have ended
  std::set<std::size_t> ended_;  ///< later ones that have
};

/// One participant's turn, while it has one. The Turns must outlive it.
class Turn {
 public:
  /// Does nothing if it has one.
  void take(Turns& turns) {
    if (turns_) return;
    number_ = turns.take();
    turns_ = &turns;
  }
  /// Takes one first, if it has none.
  void wait(Turns& turns) {
    take(turns);
    turns.wait(number_);
  }
  /// Does nothing if it has none.
  void end() {
    if (turns_) turns_->end(number_);
    turns_ = nullptr;
  }

  /// A turn that has come, until the end of a scope.
  class Held {
   public:
    explicit Held(Turn& turn) : turn_(turn) {}
    ~Held() { turn_.end(); }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;

   private:
    Turn& turn_;
  };
  /// Waits as wait() does; the turn ends with what is returned.
  [[nodiscard]] Held hold(Turns& turns) {
    wait(turns);
    return Held(*this);
  }

 private:
  Turns* turns_ = nullptr;
  std::size_t number_ = 0;
};

}  // namespace diminish
