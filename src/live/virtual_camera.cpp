#include "diminish/virtual_camera.h"

#include <atomic>
#include <mutex>
#include <opencv2/videoio.hpp>
#include <thread>

#include "core/mat.h"
#include "diminish/error.h"

namespace diminish {
namespace {

std::string pipeline_to(const std::string& target) {
  const std::string source = "appsrc ! videoconvert ! ";
  const std::string own = "gst:";
  if (target.starts_with(own)) return source + target.substr(own.size());
  return source + "video/x-raw,format=YUY2 ! v4l2sink sync=false device=" + target;
}

}  // namespace

struct VirtualCamera::Implementation {
  /// Until stopped, or the session is.
  void write_frames(const LiveSession& session) {
    constexpr std::chrono::milliseconds patience{100};
    std::size_t number = 0;
    while (!stopped) {
      const auto frame = session.wait_for_frame(number, patience);
      if (!frame && !session.status().running) break;
      if (!frame) continue;
      number = frame->number;
      video.write(as_mat(frame->result.picture));
    }
    video.release();
  }
  void fail(const std::string& what) {
    const std::lock_guard lock(mutex);
    problem = target + ": " + what;
  }

  std::string target;
  cv::VideoWriter video;
  std::atomic<bool> stopped = false;
  mutable std::mutex mutex;  ///< guards the problem
  std::string problem;
  std::thread thread;
};

VirtualCamera::VirtualCamera(const LiveSession& session, const std::string& target,
                             double frames_per_second)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  self.target = target;
  const Intrinsics& color = session.rig().color;
  if (!self.video.open(pipeline_to(target), cv::CAP_GSTREAMER, 0, frames_per_second,
                       cv::Size(color.width, color.height))) {
    throw Error(Error::device,
                target + ": cannot be opened for writing video; is v4l2loopback loaded?");
  }
  self.thread = std::thread([&self, &session] {
    try {
      self.write_frames(session);
    } catch (const std::exception& error) {
      self.fail(error.what());
    } catch (...) {
      self.fail("an unknown error");
    }
  });
}

std::string VirtualCamera::problem() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->problem;
}

VirtualCamera::~VirtualCamera() {
  implementation_->stopped = true;
  implementation_->thread.join();
}

}  // namespace diminish
