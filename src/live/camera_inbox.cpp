#include "live/camera_inbox.h"

#include <fmt/format.h>

#include <cmath>

namespace diminish {
namespace {

/// A timestamp further ahead of the clock than this is invalid.
constexpr double most_ahead_s = 1;
/// After this many images in a row that are older than the newest one, the camera's clock must have
/// been reset.
constexpr int early_before_reset = 10;

}  // namespace

CameraInbox::CameraInbox(std::string name, const Intrinsics& color,
                         const std::optional<Intrinsics>& depth)
    : name_(std::move(name)), color_sensor_(color), depth_sensor_(depth) {}

CameraInbox::Verdict CameraInbox::put(CameraImage& image, double now_s, std::string& problem) {
  const bool is_depth = image.sensor == Sensor::depth;
  if (!image.fault.empty()) {
    problem = image.fault;
    return Verdict::damaged;
  }
  if (is_depth && !depth_sensor_) {
    problem = "expected colour images, got depth";
    return Verdict::wrong_size;
  }
  const std::lock_guard lock(mutex_);
  return is_depth
             ? put(image.depth, *depth_sensor_, depth_, early_depth_, image.stamp_s, now_s, problem)
             : put(image.color, color_sensor_, color_, early_color_, image.stamp_s, now_s, problem);
}

template <class Pixel>
CameraInbox::Verdict CameraInbox::put(Image<Pixel>& image, const Intrinsics& sensor,
                                      ImageHistory<Pixel>& history, int& early, double stamp_s,
                                      double now_s, std::string& problem) {
  if (image.width() != sensor.width || image.height() != sensor.height) {
    problem = fmt::format("expected {} images of {}x{}, got {}x{}",
                          std::is_same_v<Pixel, Bgr> ? "colour" : "depth", sensor.width,
                          sensor.height, image.width(), image.height());
    return Verdict::wrong_size;
  }
  if (!std::isfinite(stamp_s) || stamp_s > now_s + most_ahead_s) {
    problem = fmt::format("a timestamp is {:.3g} s in the future", stamp_s - now_s);
    return Verdict::out_of_order;
  }
  if (history.size() > 0) {
    const double last_s = history.newest().stamp_s;
    if (stamp_s == last_s) {
      problem = "two images have the same timestamp";
      return Verdict::duplicate;
    }
    if (stamp_s < last_s) {
      problem =
          fmt::format("a timestamp is {:.3g} s before the one that came first", last_s - stamp_s);
      if (++early < early_before_reset) return Verdict::out_of_order;
      history.clear();
    }
  }
  early = 0;
  history.push(image, stamp_s, now_s);
  last_arrival_s_ = now_s;
  return Verdict::accepted;
}

std::optional<double> CameraInbox::last_arrival_s() const {
  const std::lock_guard lock(mutex_);
  return last_arrival_s_;
}

}  // namespace diminish
