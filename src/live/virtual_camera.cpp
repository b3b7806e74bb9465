#include "diminish/virtual_camera.h"

#include <atomic>
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
  cv::VideoWriter video;
  std::atomic<bool> stopped = false;
  std::thread thread;
};

VirtualCamera::VirtualCamera(const LiveSession& session, const std::string& target,
                             double frames_per_second)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  const Intrinsics& color = session.rig().color;
  if (!self.video.open(pipeline_to(target), cv::CAP_GSTREAMER, 0, frames_per_second,
                       cv::Size(color.width, color.height))) {
    throw Error(Error::device,
                target + ": cannot be opened for writing video; is v4l2loopback loaded?");
  }
  self.thread = std::thread([&self, &session] {
    constexpr std::chrono::milliseconds patience{100};
    std::size_t number = 0;
    while (!self.stopped) {
      const auto frame = session.wait_for_frame(number, patience);
      if (!frame) continue;
      number = frame->number;
      self.video.write(as_mat(frame->result.picture));
    }
    self.video.release();
  });
}

VirtualCamera::~VirtualCamera() {
  implementation_->stopped = true;
  implementation_->thread.join();
}

}  // namespace diminish
