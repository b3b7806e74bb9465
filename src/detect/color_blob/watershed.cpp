#include "detect/color_blob/watershed.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/runs.h"

namespace diminish {
namespace {

int difference(const Bgr& a, const Bgr& b) {
  return std::max({std::abs(a.b - b.b), std::abs(a.g - b.g), std::abs(a.r - b.r)});
}

/// The first unknown of `count` labels; `count` if there is none.
int first_unknown(const std::uint32_t* labels, int count) {
  return static_cast<int>(std::find(labels, labels + count, 0U) - labels);
}
int first_unknown(const std::uint8_t* labels, int count) {
  return find_equal(labels, 0, count, 0);
}

/// Pixels by a difference from 0 to 255, of each difference first in, first out.
class Queues {
 public:
  /// next: a place for each pixel.
  explicit Queues(int* next) : next_(next) {
    first_.fill(none);
    for (std::size_t i = 0; i < first_.size(); ++i) end_[i] = &first_[i];
  }
  Queues(const Queues&) = delete;
  Queues& operator=(const Queues&) = delete;

  void push(int pixel, int difference) {
    *end_[difference] = pixel;
    end_[difference] = next_ + pixel;
    next_[pixel] = none;
    least_ = std::min(least_, difference);
  }
  /// A pixel of the least difference, or `none`.
  int pop() {
    while (first_[least_] == none) {
      if (least_ == 255) return none;
      ++least_;
    }
    const int pixel = first_[least_];
    first_[least_] = next_[pixel];
    if (first_[least_] == none) end_[least_] = &first_[least_];
    return pixel;
  }

  static constexpr int none = -1;

 private:
  std::array<int, 256> first_;
  std::array<int*, 256> end_;  ///< where the next one's number is to be written
  int least_ = 255;            ///< no pixel in the queues has a smaller difference
  int* next_;
};

}  // namespace

template <class Label>
void Watershed::flood_labels(const Image<Bgr>& picture, Image<Label>& labels) {
  using Labels = WatershedLabel<Label>;
  const int width = labels.width();
  const int height = labels.height();
  line_.clear();
  std::fill_n(labels.row(0), width, Labels::line);
  std::fill_n(labels.row(height - 1), width, Labels::line);
  for (int y = 1; y + 1 < height; ++y) labels(0, y) = labels(width - 1, y) = Labels::line;
  if (width < 3 || height < 3) return;

  next_.resize(labels.size());
  Queues queues(next_.data());
  const Bgr* const colors = picture.data();
  Label* const label = labels.data();
  const std::array<int, 4> neighbors = {-1, 1, -width, width};
  for (int y = 1; y + 1 < height; ++y) {
    const int end = (y + 1) * width - 1;
    for (int pixel = y * width + 1; pixel < end; ++pixel) {
      if (label[pixel] != Labels::unknown) {
        pixel += first_unknown(label + pixel, end - pixel);
        if (pixel == end) break;
      }
      int least = 256;
      for (const int offset : neighbors) {
        if (!Labels::is_basin(label[pixel + offset])) continue;
        least = std::min(least, difference(colors[pixel], colors[pixel + offset]));
      }
      if (least == 256) continue;
      queues.push(pixel, least);
      label[pixel] = Labels::queued;
    }
  }

  // Few branches, because none of them can be predicted.
  for (int pixel = queues.pop(); pixel != Queues::none; pixel = queues.pop()) {
    Label lowest = Labels::last_basin;
    Label highest = 0;
    std::array<int, 4> unknown;
    int unknown_count = 0;
    for (const int offset : neighbors) {
      const Label neighbor = label[pixel + offset];
      const bool is_basin = Labels::is_basin(neighbor);
      lowest = std::min(lowest, is_basin ? neighbor : Labels::last_basin);
      highest = std::max(highest, is_basin ? neighbor : Label{0});
      unknown[unknown_count] = pixel + offset;
      unknown_count += neighbor == Labels::unknown ? 1 : 0;
    }
    if (lowest != highest) {
      label[pixel] = Labels::line;
      line_.push_back(pixel);
      continue;
    }
    label[pixel] = highest;
    for (int i = 0; i < unknown_count; ++i) {
      queues.push(unknown[i], difference(colors[pixel], colors[unknown[i]]));
      label[unknown[i]] = Labels::queued;
    }
  }
}

void Watershed::flood(const Image<Bgr>& picture, Image<std::uint32_t>& labels) {
  flood_labels(picture, labels);
}
void Watershed::flood(const Image<Bgr>& picture, Image<std::uint8_t>& labels) {
  flood_labels(picture, labels);
}

}  // namespace diminish
