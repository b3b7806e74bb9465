#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <string>
#include <thread>

#include "core/set_text.h"
#include "diminish/camera_source.h"

namespace diminish {

/// Reads a camera of a node until it ends or `is_stopped`; returns whether it ended. One that fails
/// is opened again: after 0.2 s, and twice as long each time while no image comes, up to 5 s, as in
/// a session. on_read(source, status, image): after each read; whether it was a good image.
/// on_failure(what).
template <class OnRead, class OnFailure>
bool read_camera(const std::string& uri, const CameraRequest& wanted,
                 const std::atomic<bool>& is_stopped, const OnRead& on_read,
                 const OnFailure& on_failure) {
  constexpr double first_retry_s = 0.2;
  constexpr double last_retry_s = 5;
  double retry_s = first_retry_s;
  while (!is_stopped) {
    bool has_images = false;
    std::string what;
    bool is_done = false;
    try {
      CameraRequest request = wanted;
      request.epoch_s = monotonic_now_s();
      const auto source = open_camera(uri, request);
      CameraImage image;
      while (!is_stopped && !is_done) {
        const auto got = source->read(image, std::chrono::milliseconds(100));
        is_done = got == CameraSource::Status::end;
        if (!is_done && on_read(*source, got, image)) has_images = true;
      }
      is_done = true;
    } catch (const std::exception& error) {
      set_text(what, error.what());
    } catch (...) {
      set_text(what, "an unknown error");
    }
    if (is_done) break;
    on_failure(what);
    retry_s = has_images ? first_retry_s : std::min(2 * retry_s, last_retry_s);
    const double end_s = monotonic_now_s() + retry_s;
    while (!is_stopped && monotonic_now_s() < end_s) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  return !is_stopped;
}

}  // namespace diminish
