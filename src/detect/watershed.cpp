#include "detect/watershed.h"

#include <cstdlib>
#include <cstring>

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
  const void* const found = std::memchr(labels, 0, static_cast<std::size_t>(count));
  return found == nullptr ? count
                          : static_cast<int>(static_cast<const std::uint8_t*>(found) - labels);
}

}  // namespace

void Watershed::push(int pixel, int difference) {
  Queue& queue = queues_[difference];
  (queue.first == none ? queue.first : next_[queue.last]) = pixel;
  queue.last = pixel;
  next_[pixel] = none;
}

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
  const Bgr* const colors = picture.data();
  Label* const label = labels.data();
  const std::array<int, 4> neighbors = {-1, 1, -width, width};
  for (int y = 1; y + 1 < height; ++y) {
    const int end = (y + 1) * width - 1;
    for (int pixel = y * width + 1; pixel < end; ++pixel) {
      pixel += first_unknown(label + pixel, end - pixel);
      if (pixel == end) break;
      int least = 256;
      for (const int offset : neighbors) {
        if (!Labels::is_basin(label[pixel + offset])) continue;
        least = std::min(least, difference(colors[pixel], colors[pixel + offset]));
      }
      if (least == 256) continue;
      push(pixel, least);
      label[pixel] = Labels::queued;
    }
  }

  for (int active = 0; active < 256;) {
    Queue& queue = queues_[active];
    if (queue.first == none) {
      ++active;
      continue;
    }
    const int pixel = queue.first;
    queue.first = next_[pixel];
    Label basin = 0;
    bool on_line = false;
    for (const int offset : neighbors) {
      const Label neighbor = label[pixel + offset];
      if (!Labels::is_basin(neighbor)) continue;
      on_line = on_line || (basin != 0 && basin != neighbor);
      basin = neighbor;
    }
    if (on_line) {
      label[pixel] = Labels::line;
      line_.push_back(pixel);
      continue;
    }
    label[pixel] = basin;
    for (const int offset : neighbors) {
      const int neighbor = pixel + offset;
      if (label[neighbor] != Labels::unknown) continue;
      const int step = difference(colors[pixel], colors[neighbor]);
      push(neighbor, step);
      label[neighbor] = Labels::queued;
      active = std::min(active, step);
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
