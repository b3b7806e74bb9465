#include "live/camera_feed.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "core/set_text.h"
#include "core/thread_name.h"

namespace diminish {
namespace {

/// A camera that delivers nothing for this long is silent.
constexpr double silent_after_s = 1;
/// A lost camera is opened again after the first time, then after twice that, up to the second.
constexpr double first_retry_s = 0.2;
constexpr double last_retry_s = 5;

std::string no_image() {
  return fmt::format("no image for {} s", silent_after_s);
}

}  // namespace

CameraFeed::CameraFeed(LiveCamera camera, const CameraRequest& request, CameraInbox& inbox,
                       ArrivalSignal& arrived)
    : camera_(std::move(camera)), request_(request), inbox_(inbox), arrived_(arrived) {
  status_.name = camera_.name;
  status_.uri = camera_.uri;
  thread_ = std::thread([this] { work(); });
}

CameraFeed::~CameraFeed() {
  stop();
  thread_.join();
}

CameraStatus CameraFeed::status() const {
  const std::lock_guard lock(mutex_);
  CameraStatus status = status_;
  status.images_per_second = arrivals_s_.rate();
  // A driver may block for a long time.
  if (status.state == CameraState::running && monotonic_now_s() - last_image_s_ > silent_after_s) {
    status.state = CameraState::silent;
    status.problem = no_image();
  }
  return status;
}

std::size_t CameraFeed::images() const {
  const std::lock_guard lock(mutex_);
  return status_.images;
}

void CameraFeed::set_state(CameraState state, const char* problem) {
  {
    const std::lock_guard lock(mutex_);
    status_.state = state;
    if (*problem != '\0') set_text(status_.problem, problem);
    if (state == CameraState::lost) {
      ++status_.failures;
      arrivals_s_.clear();
    }
  }
  arrived_.notify();
}

void CameraFeed::wait_before_reopening(double seconds) const {
  constexpr double step_s = 0.02;
  for (double waited_s = 0; waited_s < seconds && !stopped_; waited_s += step_s) {
    std::this_thread::sleep_for(std::chrono::duration<double>(step_s));
  }
}

void CameraFeed::work() {
  name_this_thread("camera");
  double retry_s = first_retry_s;
  while (!stopped_) {
    const std::size_t images_before = images();
    bool has_ended = false;
    try {
      read_until_gone();
      has_ended = true;
      if (!stopped_) set_state(CameraState::ended, "");
    } catch (const std::exception& error) {
      set_state(CameraState::lost, error.what());
    } catch (...) {
      set_state(CameraState::lost, "the camera's driver failed");
    }
    if (has_ended) return;
    if (images() > images_before) retry_s = first_retry_s;
    wait_before_reopening(retry_s);
    retry_s = std::min(2 * retry_s, last_retry_s);
  }
}

void CameraFeed::read_until_gone() {
  const auto source = open_camera(camera_.uri, request_);
  {
    const std::lock_guard lock(mutex_);
    if (status_.failures > 0) ++status_.reconnects;
    dropped_before_ = status_.dropped;
    last_image_s_ = monotonic_now_s();
  }
  CameraImage image;
  while (!stopped_) {
    const auto status = source->read(image, std::chrono::milliseconds(100));
    if (status == CameraSource::Status::end) return;
    if (status == CameraSource::Status::image) take(image);
    const std::lock_guard lock(mutex_);
    status_.dropped = dropped_before_ + source->dropped();
    status_.clock = source->clock();
    if (status_.state != CameraState::silent &&
        monotonic_now_s() - last_image_s_ > silent_after_s) {
      status_.state = CameraState::silent;
      status_.problem = no_image();
      ++status_.stalls;
    }
  }
}

void CameraFeed::take(CameraImage& image) {
  const double now_s = monotonic_now_s();
  std::string problem;
  const CameraInbox::Verdict verdict = inbox_.put(image, now_s, problem);
  {
    const std::lock_guard lock(mutex_);
    has_color_ = has_color_ || image.sensor == Sensor::color;
    const bool counts_for_rate = image.sensor == Sensor::color || !has_color_;
    switch (verdict) {
      case CameraInbox::Verdict::accepted:
        ++status_.images;
        // A stall that went unnoticed because the driver blocked.
        if (status_.state == CameraState::running && now_s - last_image_s_ > silent_after_s) {
          ++status_.stalls;
        }
        status_.state = CameraState::running;
        last_image_s_ = now_s;
        if (counts_for_rate) arrivals_s_.add(now_s);
        break;
      case CameraInbox::Verdict::duplicate:
        ++status_.duplicates;
        break;
      case CameraInbox::Verdict::out_of_order:
        ++status_.out_of_order;
        break;
      case CameraInbox::Verdict::wrong_size:
        ++status_.wrong_size;
        break;
      case CameraInbox::Verdict::damaged:
        ++status_.damaged;
        break;
    }
    if (!problem.empty()) status_.problem = problem;
  }
  if (verdict == CameraInbox::Verdict::accepted) arrived_.notify();
}

}  // namespace diminish
