#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>

#include "diminish/camera_source.h"
#include "diminish/frame_set.h"
#include "live/camera_inbox.h"

namespace diminish {

/// Two sensors' images so far apart are of one moment.
inline constexpr double moment_s = 0.02;

/// A camera's last images, two of a moment together. The camera's thread puts them in, another
/// takes pairs out: the same two images are always the same pair.
class ImagePairs {
 public:
  using Pair = std::shared_ptr<const RgbdFrame>;

  /// Takes the pixels out of `image`.
  void put(CameraImage& image) {
    const std::lock_guard lock(mutex_);
    const double now_s = monotonic_now_s();
    if (image.sensor == Sensor::color) {
      color_.push(image.color, image.stamp_s, now_s);
    } else {
      depth_.push(image.depth, image.stamp_s, now_s);
    }
    newest_s_ = image.stamp_s;
  }

  /// The images nearest to a time, if both are within the tolerance; null if not.
  Pair find(double stamp_s, double tolerance_s) {
    const std::lock_guard lock(mutex_);
    const auto* const color = color_.nearest(stamp_s, tolerance_s);
    const auto* const depth = depth_.nearest(stamp_s, tolerance_s);
    if (!color || !depth) return nullptr;
    const auto known = std::find_if(pairs_.begin(), pairs_.end(), [&](const auto& pair) {
      return pair->color_pixels == color->image && pair->depth_pixels == depth->image &&
             pair->color_stamp_s == color->stamp_s && pair->depth_stamp_s == depth->stamp_s;
    });
    if (known != pairs_.end()) return *known;
    const auto pair = std::make_shared<Held>();
    pair->color_pixels = color->image;
    pair->depth_pixels = depth->image;
    pair->color = ImageView<Bgr>(*color->image);
    pair->depth = ImageView<std::uint16_t>(*depth->image);
    pair->color_stamp_s = color->stamp_s;
    pair->depth_stamp_s = depth->stamp_s;
    pairs_.push_back(pair);
    if (pairs_.size() > most_pairs) pairs_.pop_front();
    return pair;
  }
  /// The pair of the last image, if it has one within the tolerance.
  Pair newest(double tolerance_s) {
    double stamp_s = 0;
    {
      const std::lock_guard lock(mutex_);
      stamp_s = newest_s_;
    }
    return find(stamp_s, tolerance_s);
  }

 private:
  static constexpr std::size_t most_pairs = 8;
  struct Held : RgbdFrame {
    std::shared_ptr<const Image<Bgr>> color_pixels;
    std::shared_ptr<const Image<std::uint16_t>> depth_pixels;
  };

  std::mutex mutex_;
  ImageHistory<Bgr> color_;
  ImageHistory<std::uint16_t> depth_;
  std::deque<std::shared_ptr<const Held>> pairs_;
  double newest_s_ = 0;
};

}  // namespace diminish
