#include "detect/color_blob/connected_regions.h"

#include <array>
#include <cstdlib>
#include <cstring>

namespace diminish {
namespace {

/// The first of [begin, end) that has the value; `end` if there is none.
int find_value(const std::uint8_t* row, int begin, int end, std::uint8_t value) {
  const void* const found = std::memchr(row + begin, value, static_cast<std::size_t>(end - begin));
  return found == nullptr ? end : static_cast<int>(static_cast<const std::uint8_t*>(found) - row);
}

}  // namespace

void ConnectedRegions::find(const Mask& mask, std::uint8_t value, Connectivity connectivity) {
  const auto other_value = static_cast<std::uint8_t>(255 - value);
  const int reach = connectivity == Connectivity::eight ? 1 : 0;
  runs_.clear();
  std::size_t above = 0;  // the next run of the row above that may touch
  for (int y = 0; y < mask.height(); ++y) {
    const std::uint8_t* const row = mask.row(y);
    const std::size_t above_end = runs_.size();
    for (int x = 0; x < mask.width();) {
      const int first = find_value(row, x, mask.width(), value);
      if (first == mask.width()) break;
      const int last = find_value(row, first, mask.width(), other_value);
      x = last;
      const int run = static_cast<int>(runs_.size());
      runs_.push_back({y, first, last, run});
      while (above < above_end && runs_[above].last + reach <= first) ++above;
      for (std::size_t i = above; i < above_end && runs_[i].first < last + reach; ++i) {
        const int a = root(run);
        const int b = root(static_cast<int>(i));
        runs_[std::max(a, b)].region = std::min(a, b);
      }
    }
    above = above_end;
  }
  number_regions();
}

int ConnectedRegions::root(int run) {
  while (runs_[run].region != run) {
    runs_[run].region = runs_[runs_[run].region].region;
    run = runs_[run].region;
  }
  return run;
}

void ConnectedRegions::number_regions() {
  regions_.clear();
  for (int i = 0; i < static_cast<int>(runs_.size()); ++i) {
    Run& run = runs_[i];
    // Runs point to earlier ones, which have their numbers already.
    if (run.region == i) {
      run.region = static_cast<int>(regions_.size());
      regions_.push_back({{}, 0, {run.first, run.y}});
    } else {
      run.region = runs_[run.region].region;
    }
    Region& region = regions_[run.region];
    region.box = join(region.box, {run.first, run.y, run.last - run.first, 1});
    region.pixels += run.last - run.first;
  }
}

void trace_outline(const Mask& mask, const Eigen::Vector2i& first, Outline& outline) {
  // Clockwise, as y points down.
  static const std::array<Eigen::Vector2i, 8> directions = {
      Eigen::Vector2i{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};
  const auto is_set = [&](const Eigen::Vector2i& pixel) {
    return mask.bounds().contains(pixel.x(), pixel.y()) && mask(pixel.x(), pixel.y()) != 0;
  };
  outline.clear();
  Eigen::Vector2i pixel = first;
  int first_step = -1;
  int search = 0;  // nothing of the region is above or to the left of its first pixel
  for (;;) {
    int step = -1;
    for (int i = 0; i < 8 && step < 0; ++i) {
      const int direction = (search + i) % 8;
      if (is_set(pixel + directions[direction])) step = direction;
    }
    if (!outline.empty() && pixel == first && step == first_step) return;
    outline.push_back(pixel);
    if (step < 0) return;  // a single pixel
    if (first_step < 0) first_step = step;
    pixel += directions[step];
    // Next to where it came from, on the outer side: that one was empty.
    search = (step + (step % 2 == 0 ? 7 : 6)) % 8;
  }
}

double polygon_area(const Outline& outline) {
  std::int64_t doubled = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2i& a = outline[i];
    const Eigen::Vector2i& b = outline[i + 1 < outline.size() ? i + 1 : 0];
    doubled += std::int64_t{a.x()} * b.y() - std::int64_t{a.y()} * b.x();
  }
  return static_cast<double>(std::abs(doubled)) / 2;
}

}  // namespace diminish
