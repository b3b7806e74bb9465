#include "live/motion_signal.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace diminish {
namespace {

constexpr int thinned_width = 160;
constexpr double step_s = 0.005;
/// How long the signals must overlap at every shift.
constexpr double least_overlap_s = 2;
constexpr double least_correlation = 0.6;
/// Grey levels; anything below is noise.
constexpr double least_motion = 0.05;

void thin(ImageView<Bgr> image, Image<std::uint8_t>& thinned) {
  const int step = std::max(1, image.width() / thinned_width);
  thinned.resize(image.width() / step, image.height() / step);
  for (int y = 0; y < thinned.height(); ++y) {
    for (int x = 0; x < thinned.width(); ++x) {
      // A block's mean instead of one pixel, so that noise does not look like motion.
      int sum = 0;
      for (int dy = 0; dy < step; ++dy) {
        const Bgr* row = image.row(y * step + dy) + x * step;
        for (int dx = 0; dx < step; ++dx) sum += row[dx].g;
      }
      thinned(x, y) = static_cast<std::uint8_t>(sum / (step * step));
    }
  }
}

/// Resamples a signal at even steps by linear interpolation.
std::vector<double> resample(const std::vector<MotionSample>& signal, double begin_s,
                             std::size_t count) {
  std::vector<double> even(count);
  std::size_t next = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = begin_s + step_s * static_cast<double>(i);
    while (next + 1 < signal.size() && signal[next].stamp_s < time_s) ++next;
    const MotionSample& a = signal[next - 1];
    const MotionSample& b = signal[next];
    const double share = std::clamp((time_s - a.stamp_s) / (b.stamp_s - a.stamp_s), 0.0, 1.0);
    even[i] = (1 - share) * a.amount + share * b.amount;
  }
  return even;
}

/// The correlation coefficient of `count` values from `a` and `b`.
double correlation(const double* a, const double* b, std::size_t count) {
  const auto n = static_cast<double>(count);
  const double mean_a = std::accumulate(a, a + count, 0.0) / n;
  const double mean_b = std::accumulate(b, b + count, 0.0) / n;
  double ab = 0;
  double aa = 0;
  double bb = 0;
  for (std::size_t i = 0; i < count; ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  const double least = n * least_motion * least_motion;
  return aa < least || bb < least ? 0 : ab / std::sqrt(aa * bb);
}

}  // namespace

std::optional<MotionSample> MotionMeter::add(ImageView<Bgr> image, double stamp_s) {
  thin(image, thinned_);
  std::optional<MotionSample> motion;
  if (last_.width() == thinned_.width() && last_.height() == thinned_.height()) {
    double sum = 0;
    for (std::size_t i = 0; i < last_.size(); ++i) {
      sum += std::abs(last_.data()[i] - thinned_.data()[i]);
    }
    // Per second, because images that are further apart differ more.
    const double period_s = std::max(stamp_s - last_stamp_s_, 1e-3);
    constexpr double usual_period_s = 1.0 / 30;
    motion = {.stamp_s = (stamp_s + last_stamp_s_) / 2,
              .amount = sum / static_cast<double>(last_.size()) * usual_period_s / period_s};
  }
  std::swap(last_, thinned_);
  last_stamp_s_ = stamp_s;
  return motion;
}

std::optional<SyncOffset> estimate_sync_offset(const std::vector<MotionSample>& first,
                                               const std::vector<MotionSample>& second,
                                               double largest_s) {
  if (first.size() < 2 || second.size() < 2) return std::nullopt;
  // The first signal without its ends, so that the second can be shifted against it.
  const double begin_s = std::max(first.front().stamp_s, second.front().stamp_s);
  const double end_s = std::min(first.back().stamp_s, second.back().stamp_s);
  const auto steps = static_cast<std::ptrdiff_t>(largest_s / step_s);
  const double inner_s = end_s - begin_s - 2 * largest_s;
  if (inner_s < least_overlap_s) return std::nullopt;
  const auto count = static_cast<std::size_t>(inner_s / step_s);
  const auto shifts = static_cast<std::size_t>(2 * steps + 1);
  const std::vector<double> a = resample(first, begin_s + largest_s, count);
  const std::vector<double> b = resample(second, begin_s, count + shifts - 1);
  std::vector<double> agreement(shifts);
  for (std::size_t i = 0; i < shifts; ++i)
    agreement[i] = correlation(a.data(), b.data() + i, count);
  const auto best = std::max_element(agreement.begin(), agreement.end()) - agreement.begin();
  const double peak = agreement[static_cast<std::size_t>(best)];
  if (peak < least_correlation || best == 0 || best == 2 * steps) return std::nullopt;
  // The top of the parabola through the peak and its neighbours.
  const double before = agreement[static_cast<std::size_t>(best - 1)];
  const double after = agreement[static_cast<std::size_t>(best + 1)];
  const double curvature = before - 2 * peak + after;
  const double fraction = curvature < 0 ? 0.5 * (before - after) / curvature : 0;
  return SyncOffset{step_s * (static_cast<double>(best - steps) + fraction), peak};
}

}  // namespace diminish
