#include "live/virtual_camera.h"

#include <opencv2/videoio.hpp>

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

struct VirtualCamera::Writer {
  cv::VideoWriter video;
};

VirtualCamera::VirtualCamera(const LiveSession& session, const std::string& target,
                             double frames_per_second)
    : writer_(std::make_unique<Writer>()) {
  const Intrinsics& color = session.rig().color;
  if (!writer_->video.open(pipeline_to(target), cv::CAP_GSTREAMER, 0, frames_per_second,
                           cv::Size(color.width, color.height))) {
    throw Error(Error::device,
                target + ": cannot be opened for writing video; is v4l2loopback loaded?");
  }
  thread_ = std::thread([this, &session] {
    constexpr std::chrono::milliseconds patience{100};
    std::size_t number = 0;
    while (!stopped_) {
      const auto frame = session.wait_for_frame(number, patience);
      if (!frame) continue;
      number = frame->number;
      writer_->video.write(as_mat(frame->result.picture));
    }
    writer_->video.release();
  });
}

VirtualCamera::~VirtualCamera() {
  stopped_ = true;
  thread_.join();
}

}  // namespace diminish
