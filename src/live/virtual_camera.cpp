#include "diminish/virtual_camera.h"

#include <opencv2/videoio.hpp>
#include <optional>

#include "core/mat.h"
#include "diminish/error.h"
#include "live/frame_forwarder.h"

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
  std::string target;
  cv::VideoWriter video;
  std::optional<FrameForwarder> forwarder;  ///< last: it writes the video
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
  self.forwarder.emplace(
      session, [&self](const LiveFrame& frame) { self.video.write(as_mat(frame.result.picture)); });
}

std::string VirtualCamera::problem() const {
  const std::string what = implementation_->forwarder->problem();
  return what.empty() ? what : implementation_->target + ": " + what;
}

VirtualCamera::~VirtualCamera() = default;

}  // namespace diminish
