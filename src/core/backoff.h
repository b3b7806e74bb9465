#pragma once

#include <algorithm>

namespace diminish {

/// When to try again what has failed: at once, then after twice as many frames each time.
class Backoff {
 public:
  /// Whether this frame tries. Ask once a frame.
  bool is_due() {
    if (skipped_ <= 0) return true;
    --skipped_;
    return false;
  }
  void fail() {
    skipped_ = next_;
    next_ = std::min(2 * next_ + 1, most);
  }
  void succeed() { next_ = 0; }

 private:
  static constexpr int most = 1023;  ///< half a minute of frames
  int skipped_ = 0;
  int next_ = 0;
};

}  // namespace diminish
