#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>

#include "diminish/camera_source.h"
#include "live/pool.h"

namespace diminish {

/// The last few images of one sensor, in the order of their timestamps. Whoever finds one may keep
/// it; when nobody does, its memory is used for a later image.
template <class Pixel>
class ImageHistory {
 public:
  static constexpr std::size_t capacity = 6;

  struct Entry {
    std::shared_ptr<Image<Pixel>> image;
    double stamp_s = 0;
    double arrival_s = 0;
  };

  std::size_t size() const { return size_; }
  /// 0: the newest.
  const Entry& newest(std::size_t age = 0) const {
    return entries_[(end_ + capacity - 1 - age) % capacity];
  }

  /// Takes the pixels out of `image`, which gets an earlier image's memory.
  void push(Image<Pixel>& image, double stamp_s, double arrival_s) {
    Entry& entry = entries_[end_];
    entry.image.reset();
    entry.image = pool_.take();
    std::swap(*entry.image, image);
    entry.stamp_s = stamp_s;
    entry.arrival_s = arrival_s;
    end_ = (end_ + 1) % capacity;
    size_ = std::min(size_ + 1, capacity);
  }
  void clear() { size_ = 0; }

  /// The entry nearest in time (the earlier of two equally near); null if none is within the
  /// tolerance.
  const Entry* nearest(double stamp_s, double tolerance_s) const {
    const Entry* best = nullptr;
    for (std::size_t age = size_; age-- > 0;) {
      const Entry& entry = newest(age);
      const double distance_s = std::abs(entry.stamp_s - stamp_s);
      if (distance_s > tolerance_s) continue;
      if (!best || distance_s < std::abs(best->stamp_s - stamp_s)) best = &entry;
    }
    return best;
  }

 private:
  Pool<Image<Pixel>> pool_;
  std::array<Entry, capacity> entries_;
  std::size_t end_ = 0;
  std::size_t size_ = 0;
};

/// Where a camera's threads put their images and the pipeline's thread finds them. Refuses unusable
/// images.
class CameraInbox {
 public:
  enum class Verdict { accepted, duplicate, out_of_order, wrong_size, damaged };

  /// color, depth: the sensors. The user's camera has no depth.
  CameraInbox(std::string name, const Intrinsics& color, const std::optional<Intrinsics>& depth);

  const std::string& name() const { return name_; }
  bool has_depth() const { return depth_sensor_.has_value(); }

  /// Takes the image out of `image` if it can be used. Otherwise `problem` says why not, in plain
  /// words.
  Verdict put(CameraImage& image, double now_s, std::string& problem);

  /// Calls `look(color, depth)` with the histories while nothing else touches them.
  template <class Look>
  auto with_images(Look&& look) {
    const std::lock_guard lock(mutex_);
    return look(color_, depth_);
  }

  /// When the last image of either sensor came; nothing before the first.
  std::optional<double> last_arrival_s() const;

 private:
  template <class Pixel>
  Verdict put(Image<Pixel>& image, const Intrinsics& sensor, ImageHistory<Pixel>& history,
              int& early, double stamp_s, double now_s, std::string& problem);

  std::string name_;
  Intrinsics color_sensor_;
  std::optional<Intrinsics> depth_sensor_;
  mutable std::mutex mutex_;
  ImageHistory<Bgr> color_;
  ImageHistory<std::uint16_t> depth_;
  int early_color_ = 0,
      early_depth_ = 0;  ///< refused in a row because their timestamp was too early
  std::optional<double> last_arrival_s_;
};

}  // namespace diminish
