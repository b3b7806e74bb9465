#include "scene/stream_delay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/quick_brightness.h"
#include "core/shrink.h"

namespace diminish {
namespace {

constexpr int columns_for_delay = 320;
constexpr double bin_s = 1 / 30.;
constexpr double longest_s = 0.3;
/// Between moments that are compared.
constexpr double apart_s = 0.06;
/// What was seen longer ago counts less.
constexpr double half_life_s = 0.5;
/// A change that noise does not make, levels.
constexpr int least_change = 24;
constexpr double greatest_error = 60;
/// Of changed samples, at a lag.
constexpr double fewest = 100;
/// A delay that harms.
constexpr double least_late_s = 0.05;
/// The error at the true lag, of that now. With good cameras, now has the least; in a single frame
/// an earlier moment may by chance have .82 of it.
constexpr double still_as_good = 0.93;
constexpr double still_as_good_at_once = 0.75;

/// How bright the user's camera shows what an RGB-D camera shows: a line, by least squares.
class Relation {
 public:
  void add(double shown, double own) {
    count_ += 1;
    shown_ += shown;
    own_ += own;
    product_ += shown * own;
    square_ += own * own;
  }
  bool is_known() const { return square_ - own_ * own_ / std::max(1., count_) > count_; }
  double operator()(double own) const {
    const double gain = (product_ - shown_ * own_ / count_) / (square_ - own_ * own_ / count_);
    return shown_ / count_ + gain * (own - own_ / count_);
  }

 private:
  double count_ = 0, shown_ = 0, own_ = 0, product_ = 0, square_ = 0;
};

}  // namespace

StreamDelay::StreamDelay(const Intrinsics& color)
    : projection_(Lens(color)), shrinkage_(std::max(1, color.width / columns_for_delay)) {}

void StreamDelay::find(const Inputs& inputs, std::vector<std::optional<double>>& late_s) {
  const Turn::Held turn = turn_.hold(shared_->turns);
  remember(inputs, late_s.size());
  choose_moments(inputs);
  const std::vector<SceneSample>& samples = inputs.samples.surfaces;
  std::size_t begin = 0;
  for (std::size_t k = 0; k < late_s.size(); ++k) {
    std::size_t last = begin;
    while (last < samples.size() && samples[last].source <= k + 1) ++last;
    Errors now;
    compare(inputs, begin, last, now);
    Errors& errors = shared_->errors[k];
    for (std::size_t bin = 0; bin < bins; ++bin) {
      errors.levels[bin] += now.levels[bin];
      errors.count[bin] += now.count[bin];
    }
    // A stream that has just become late has a past without fault.
    late_s[k] = delay_of(now, still_as_good_at_once);
    if (!late_s[k]) late_s[k] = delay_of(errors, still_as_good);
    begin = last;
  }
}

std::optional<double> StreamDelay::delay_of(const Errors& errors, double share) {
  if (errors.count[0] < fewest) return std::nullopt;
  const double now = errors.levels[0] / errors.count[0];
  double least = share * now;
  std::optional<double> delay_s;
  for (std::size_t bin = 1; bin < bins; ++bin) {
    if (errors.count[bin] < fewest) continue;
    const double error = errors.levels[bin] / errors.count[bin];
    if (error >= least) continue;
    least = error;
    delay_s = static_cast<double>(bin) * bin_s;
  }
  return delay_s && *delay_s >= least_late_s ? delay_s : std::nullopt;
}

void StreamDelay::remember(const Inputs& inputs, std::size_t cameras) {
  std::vector<Moment>& moments = shared_->moments;
  std::vector<Errors>& errors = shared_->errors;
  constexpr double longest_pause_s = 1;
  const double lost_s = moments.empty() ? 0 : inputs.stamp_s - moments.back().stamp_s;
  if (!moments.empty() && !(lost_s > 0 && lost_s < longest_pause_s)) {
    while (!moments.empty()) forget_oldest();
    errors.clear();
  }
  errors.resize(cameras);
  const double left = std::exp2(-lost_s / half_life_s);
  for (Errors& of_camera : errors) {
    for (double& levels : of_camera.levels) levels *= left;
    for (double& count : of_camera.count) count *= left;
  }
  while (!moments.empty() && moments.front().stamp_s < inputs.stamp_s - longest_s) forget_oldest();
  Moment now;
  if (!shared_->spare.empty()) {
    now.grey = std::move(shared_->spare.back());
    shared_->spare.pop_back();
  }
  now.stamp_s = inputs.stamp_s;
  now.color_from_world = inputs.color_from_world;
  shrink_outside(inputs.picture, inputs.occlusion, shrinkage_, now.grey);
  moments.push_back(std::move(now));
}

void StreamDelay::forget_oldest() {
  std::vector<Moment>& moments = shared_->moments;
  shared_->spare.push_back(std::move(moments.front().grey));
  moments.erase(moments.begin());
}

void StreamDelay::choose_moments(const Inputs& inputs) {
  chosen_.clear();
  double last_s = inputs.stamp_s + 1;
  const RigidTransform world_from_color = inputs.color_from_world.inverse();
  const std::vector<Moment>& moments = shared_->moments;
  for (std::size_t i = moments.size(); i-- > 0;) {
    const Moment& moment = moments[i];
    if (chosen_.size() == most_moments || moment.stamp_s > last_s - apart_s) continue;
    last_s = moment.stamp_s;
    const auto bin =
        static_cast<std::size_t>(std::lround((inputs.stamp_s - moment.stamp_s) / bin_s));
    if (bin >= bins) break;
    chosen_.push_back(
        {&moment.grey, FloatTransform(moment.color_from_world * world_from_color), bin});
  }
}

void StreamDelay::compare(const Inputs& inputs, std::size_t begin, std::size_t end,
                          Errors& errors) {
  const std::vector<Then>& moments = chosen_;
  if (moments.size() < 2) return;
  const auto scale = 1 / static_cast<float>(shrinkage_);
  /// 0 where it is not known
  const auto level_at = [&](const Image<std::uint8_t>& grey, float u, float v) {
    const float column = (u + 0.5F) * scale;
    const float row = (v + 0.5F) * scale;
    const bool is_inside = column >= 0 && row >= 0 && column < static_cast<float>(grey.width()) &&
                           row < static_cast<float>(grey.height());
    return is_inside ? int{grey(static_cast<int>(column), static_cast<int>(row))} : 0;
  };
  const auto level_then = [&](const Then& then, const Eigen::Vector3f& point_m) {
    const auto at = project_exactly(projection_, transform(then.from_now, point_m));
    return at ? level_at(*then.grey, at->x(), at->y()) : 0;
  };
  changed_.clear();
  Relation relation;
  for (std::size_t i = begin; i < end; ++i) {
    const SceneSample& sample = inputs.samples.surfaces[i];
    Changed seen{static_cast<float>(quick_brightness(sample.color)) / 4, {}};
    int least = 255;
    int greatest = 0;
    for (std::size_t m = 0; m < moments.size() && least > 0; ++m) {
      seen.then[m] = m == 0 ? level_at(*moments[0].grey, sample.pixel.x(), sample.pixel.y())
                            : level_then(moments[m], sample.point_m);
      least = std::min(least, seen.then[m]);
      greatest = std::max(greatest, seen.then[m]);
    }
    if (least == 0) continue;
    if (greatest - least >= least_change) {
      changed_.push_back(seen);
    } else {
      relation.add(seen.then[0], seen.level);
    }
  }
  if (!relation.is_known()) return;
  for (const Changed& seen : changed_) {
    const double expected = relation(seen.level);
    for (std::size_t m = 0; m < moments.size(); ++m) {
      errors.levels[moments[m].bin] += std::min(greatest_error, std::abs(seen.then[m] - expected));
      errors.count[moments[m].bin] += 1;
    }
  }
}

}  // namespace diminish
