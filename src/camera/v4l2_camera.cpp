#include <fmt/format.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <opencv2/videoio.hpp>
#include <system_error>

#include "core/mat.h"
#include "core/text.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"

namespace diminish {
namespace {

constexpr const char* video_class = "/sys/class/video4linux";

/// "1280x1024"
cv::Size parse_size(const CameraUri& uri) {
  const std::string text = uri.text_of("size", "");
  const std::size_t cross = text.find('x');
  const auto width = parse_number(text.substr(0, cross));
  const auto height =
      cross == std::string::npos ? std::nullopt : parse_number(text.substr(cross + 1));
  if (!width || !height || *width < 1 || *height < 1 || *width > 16384 || *height > 16384) {
    uri.fail("size: expected a size such as 1280x1024, got '" + printable(text) + "'");
  }
  return {static_cast<int>(*width), static_cast<int>(*height)};
}

/// A webcam through Video4Linux.
class V4l2Camera : public CameraSource {
 public:
  V4l2Camera(const CameraUri& uri, const CameraRequest&) {
    uri.expect_parameters({"size", "fps", "fourcc"});
    std::error_code ignored;
    if (!std::filesystem::is_character_file(uri.target, ignored)) {
      uri.fail("there is no such device", Error::device);
    }
    if (!capture_.open(uri.target, cv::CAP_V4L2))
      uri.fail("cannot be opened as a camera", Error::device);
    const std::string fourcc = uri.text_of("fourcc", "");
    if (!fourcc.empty()) {
      if (fourcc.size() != 4) uri.fail("fourcc: expected four letters, such as MJPG");
      capture_.set(cv::CAP_PROP_FOURCC,
                   cv::VideoWriter::fourcc(fourcc[0], fourcc[1], fourcc[2], fourcc[3]));
    }
    if (uri.has("size")) {
      const cv::Size size = parse_size(uri);
      capture_.set(cv::CAP_PROP_FRAME_WIDTH, size.width);
      capture_.set(cv::CAP_PROP_FRAME_HEIGHT, size.height);
    }
    if (uri.has("fps")) capture_.set(cv::CAP_PROP_FPS, uri.number("fps", 30, 1, 1000));
    // The newest image, not the one that has waited longest.
    capture_.set(cv::CAP_PROP_BUFFERSIZE, 1);
  }

  Status read(CameraImage& image, std::chrono::milliseconds) override {
    if (!capture_.grab()) throw Error(Error::device, "the camera delivers nothing any more");
    const double now_s = monotonic_now_s();
    // The driver's buffer timestamp, where OpenCV passes it on: on the monotonic clock.
    const double driver_s = capture_.get(cv::CAP_PROP_POS_MSEC) / 1000;
    const bool is_plausible = driver_s > now_s - 1 && driver_s <= now_s;
    image.sensor = Sensor::color;
    image.stamp_s = is_plausible ? driver_s : now_s;
    image.fault.clear();
    if (!capture_.retrieve(decoded_) || decoded_.type() != CV_8UC3) {
      image.fault = "an image cannot be decoded";
      return Status::image;
    }
    copy_from(decoded_, image.color);
    return Status::image;
  }

 private:
  cv::VideoCapture capture_;
  cv::Mat decoded_;
};

std::vector<CameraDevice> list_devices() {
  std::vector<CameraDevice> devices;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(video_class, ignored)) {
    std::string name;
    std::getline(std::ifstream(entry.path() / "name"), name);
    devices.push_back({"v4l2:/dev/" + entry.path().filename().string(), printable(name)});
  }
  return devices;
}

const bool v4l2_camera_registered = Registry<CameraSource>::add(
    "v4l2", {.open =
                 [](const CameraUri& uri, const CameraRequest& request) {
                   return std::make_unique<V4l2Camera>(uri, request);
                 },
             .list = list_devices,
             .help = "v4l2:/dev/video0?size=1280x1024&fps=30&fourcc=MJPG  a webcam"});

}  // namespace
}  // namespace diminish
