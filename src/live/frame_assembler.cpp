#include "live/frame_assembler.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/robust.h"

namespace diminish {
namespace {

constexpr double always_s = -std::numeric_limits<double>::infinity();
constexpr double usual_period_s = 1.0 / 30;
/// The least time that a colour image waits, and the time that it waits beyond what earlier ones
/// needed, if no other time is set.
constexpr double least_wait_s = 0.06;
constexpr double more_wait_s = 0.02;

/// The median time from one image to the next.
double period_s(const ImageHistory<Bgr>& history) {
  std::array<double, ImageHistory<Bgr>::capacity> periods;
  const std::size_t count = history.size() < 2 ? 0 : history.size() - 1;
  for (std::size_t i = 0; i < count; ++i) {
    periods[i] = history.newest(i).stamp_s - history.newest(i + 1).stamp_s;
  }
  if (count == 0) return usual_period_s;
  return median(periods.begin(), periods.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

FrameAssembler::FrameAssembler(CameraInbox& color, std::vector<CameraInbox*> rgbd)
    : color_(color), rgbd_(std::move(rgbd)), last_stamp_s_(always_s) {}

double FrameAssembler::sync_tolerance_s(const Settings& settings) {
  if (settings.sync_tolerance_s > 0) return settings.sync_tolerance_s;
  return color_.with_images([](const auto& color, const auto&) { return period_s(color) / 2; });
}

double FrameAssembler::sync_wait_s(const Settings& settings) {
  if (settings.sync_wait_s > 0) return settings.sync_wait_s;
  const double tolerance_s = sync_tolerance_s(settings);
  Arrivals arrivals;
  const std::size_t count = find_arrivals(always_s, arrivals);
  double latest_s = 0;
  for (CameraInbox* camera : rgbd_) {
    camera->with_images([&](const auto& color, const auto& depth) {
      for (std::size_t i = 0; i < count; ++i) {
        const auto* color_image = color.nearest(arrivals[i].stamp_s, tolerance_s);
        if (!color_image) continue;
        double complete_s = color_image->arrival_s;
        if (camera->has_depth()) {
          const auto* depth_image = depth.nearest(arrivals[i].stamp_s, tolerance_s);
          if (!depth_image) continue;
          complete_s = std::max(complete_s, depth_image->arrival_s);
        }
        latest_s = std::max(latest_s, complete_s - arrivals[i].arrival_s);
      }
    });
  }
  return std::max(least_wait_s, latest_s + more_wait_s);
}

std::size_t FrameAssembler::find_arrivals(double after_s, Arrivals& arrivals) {
  return color_.with_images([&](const auto& color, const auto&) {
    std::size_t found = 0;
    for (; found < color.size() && color.newest(found).stamp_s > after_s; ++found) {
      arrivals[found] = {color.newest(found).stamp_s, color.newest(found).arrival_s};
    }
    return found;
  });
}

bool FrameAssembler::is_complete(double stamp_s, double tolerance_s,
                                 const std::function<bool(std::size_t)>& is_expected) {
  for (std::size_t k = 0; k < rgbd_.size(); ++k) {
    if (!is_expected(k)) continue;
    const bool has_all = rgbd_[k]->with_images([&](const auto& color, const auto& depth) {
      return color.nearest(stamp_s, tolerance_s) &&
             (!rgbd_[k]->has_depth() || depth.nearest(stamp_s, tolerance_s));
    });
    if (!has_all) return false;
  }
  return true;
}

std::optional<double> FrameAssembler::next_deadline_s(const Settings& settings) {
  Arrivals arrivals;
  const std::size_t count = find_arrivals(last_stamp_s_, arrivals);
  if (count == 0) return std::nullopt;
  return arrivals[count - 1].arrival_s + sync_wait_s(settings);
}

std::optional<std::size_t> FrameAssembler::assemble(
    const Settings& settings, double now_s, const std::function<bool(std::size_t)>& is_expected,
    FrameSet& frame, Pixels& pixels) {
  const double tolerance_s = sync_tolerance_s(settings);
  const double wait_s = sync_wait_s(settings);
  // After a reset of the camera's clock all images count as new.
  const bool was_reset = color_.with_images([&](const auto& color, const auto&) {
    return color.size() > 0 && color.newest().stamp_s < last_stamp_s_;
  });
  if (was_reset) last_stamp_s_ = always_s;
  Arrivals candidates;
  const std::size_t count = find_arrivals(last_stamp_s_, candidates);
  for (std::size_t i = 0; i < count; ++i) {
    const bool waited_long = now_s >= candidates[i].arrival_s + wait_s;
    if (!waited_long && !is_complete(candidates[i].stamp_s, tolerance_s, is_expected)) continue;
    const auto image = color_.with_images([&](const auto& color, const auto&) {
      const auto* entry = color.nearest(candidates[i].stamp_s, 0);
      return entry ? entry->image : nullptr;
    });
    if (!image) return std::nullopt;
    pixels.assign(1, image);
    frame.color = ImageView<Bgr>(*image);
    last_stamp_s_ = candidates[i].stamp_s;
    frame.stamp_s = candidates[i].stamp_s;
    frame.index = next_index_++;
    frame.name = fmt::format("{:06}", frame.index);
    frame.masks.clear();
    frame.faults.clear();
    frame.rgbd.resize(rgbd_.size());
    for (std::size_t k = 0; k < rgbd_.size(); ++k) fill_rgbd(k, tolerance_s, frame, pixels);
    return count - 1 - i;
  }
  return std::nullopt;
}

void FrameAssembler::fill_rgbd(std::size_t camera, double tolerance_s, FrameSet& frame,
                               Pixels& pixels) {
  RgbdFrame& rgbd = frame.rgbd[camera];
  rgbd_[camera]->with_images([&](const auto& color, const auto& depth) {
    const auto view = [&](const auto& history, auto& image, double& stamp_s) {
      const auto* entry = history.nearest(frame.stamp_s, tolerance_s);
      if (!entry) return false;
      pixels.push_back(entry->image);
      image = ImageView(*entry->image);
      stamp_s = entry->stamp_s;
      return true;
    };
    const bool has_color = view(color, rgbd.color, rgbd.color_stamp_s);
    rgbd.depth_stamp_s = rgbd.color_stamp_s;  // of an estimated depth image
    const bool has_depth =
        !rgbd_[camera]->has_depth() || view(depth, rgbd.depth, rgbd.depth_stamp_s);
    rgbd.missing.clear();
    if (has_color && has_depth) return;
    rgbd.missing = fmt::format("{}: no {} image within {:.2g} s", rgbd_[camera]->name(),
                               has_color ? "depth" : "color", tolerance_s);
    rgbd.color.own().resize(0, 0);
    rgbd.depth.own().resize(0, 0);
  });
}

}  // namespace diminish
