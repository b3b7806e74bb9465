#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "diminish/image.h"

namespace diminish {

/// An image whose surroundings are `outside`, so that what is around a pixel is there at the edges,
/// too. Pixels have several channels, one after the other.
template <class Value>
class Padded {
 public:
  static constexpr int margin = 3;

  void resize(const Rect& bounds, int channels, Value outside) {
    const int width = (bounds.width + 2 * margin) * channels;
    const int height = bounds.height + 2 * margin;
    channels_ = channels;
    if (image_.width() == width && image_.height() == height) return;
    image_.resize(width, height, outside);
  }
  void fill(Value value) { image_.fill(value); }

  int channels() const { return channels_; }
  std::ptrdiff_t pitch() const { return image_.width(); }
  Value* at(int x, int y) { return image_.row(y + margin) + (x + margin) * channels_; }
  const Value* at(int x, int y) const { return image_.row(y + margin) + (x + margin) * channels_; }

 private:
  Image<Value> image_;
  int channels_ = 1;
};

/// Puts into each of some values what `combine` makes of it and two others. Apart, so that a
/// compiler sees that the count does not change: bytes that are written may be anything.
template <class Value, class Combine>
void combine_all(const Value* before, const Value* after, int count, const Combine& combine,
                 Value* to) {
  for (int i = 0; i < count; ++i) to[i] = combine(to[i], combine(before[i], after[i]));
}

/// Combines each pixel of a part with those within `reach` (at most Padded::margin) in columns and
/// rows: their least value, their greatest or their sum, by what `combine` does with two. across:
/// scratch memory.
template <class Value, class Combine>
void combine_around(const Padded<Value>& image, const Rect& part, int reach, const Combine& combine,
                    Padded<Value>& across, Padded<Value>& result) {
  const int count = part.width * image.channels();
  const auto along = [&](const Value* from, std::ptrdiff_t step, Value* to) {
    std::copy_n(from, count, to);
    for (int k = 1; k <= reach; ++k) {
      combine_all(from - k * step, from + k * step, count, combine, to);
    }
  };
  for (int y = part.y - reach; y < part.bottom() + reach; ++y) {
    along(image.at(part.x, y), image.channels(), across.at(part.x, y));
  }
  for (int y = part.y; y < part.bottom(); ++y) {
    along(across.at(part.x, y), across.pitch(), result.at(part.x, y));
  }
}

/// The depths and colours around each place of a camera's image.
class Surroundings {
 public:
  static constexpr float nothing_m = 1e9F;

  /// Of each place of a part, those within `reach`. depth_m: 0: nothing was measured, and colours
  /// do not count. Cost: 5 ns a place.
  void find(const Image<float>& depth_m, const Image<Bgr>& color, int reach, const Rect& part);

  /// The least and the greatest; `nothing_m` and 0 if nothing was measured.
  float least_m(int x, int y) const { return *least_m_.at(x, y); }
  float greatest_m(int x, int y) const { return *greatest_m_.at(x, y); }
  /// Of a place and those after it in its row.
  const float* least_row_m(int x, int y) const { return least_m_.at(x, y); }
  const float* greatest_row_m(int x, int y) const { return greatest_m_.at(x, y); }
  /// The least and the greatest of each channel; 255 and 0.
  const std::uint8_t* low(int x, int y) const { return low_.at(x, y); }
  const std::uint8_t* high(int x, int y) const { return high_.at(x, y); }

 private:
  Padded<float> own_least_m_, own_greatest_m_, depths_across_, least_m_, greatest_m_;
  Padded<std::uint8_t> own_low_, own_high_, colors_across_, low_, high_;
};

}  // namespace diminish
