#pragma once

#include <cstddef>
#include <vector>

namespace diminish {

/// The last `capacity` values.
class SlidingWindow {
 public:
  explicit SlidingWindow(std::size_t capacity) : capacity_(capacity) { values_.reserve(capacity); }

  void add(double value) {
    if (values_.size() < capacity_) {
      values_.push_back(value);
    } else {
      values_[next_] = value;
    }
    next_ = (next_ + 1) % capacity_;
  }
  void clear() {
    values_.clear();
    next_ = 0;
  }
  bool full() const { return values_.size() == capacity_; }
  /// In any order.
  const std::vector<double>& values() const { return values_; }
  /// For values that only grow, such as times: how many there are per unit; 0 for fewer than two.
  double rate() const {
    if (values_.size() < 2) return 0;
    const std::size_t last = (next_ + capacity_ - 1) % capacity_;
    const std::size_t first = full() ? next_ % capacity_ : 0;
    const double span = values_[last] - values_[first];
    return span > 0 ? static_cast<double>(values_.size() - 1) / span : 0;
  }

 private:
  std::size_t capacity_;
  std::vector<double> values_;
  std::size_t next_ = 0;
};

}  // namespace diminish
