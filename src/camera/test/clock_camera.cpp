#include "camera/test/clock_code.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"

namespace diminish {
namespace {

/// Another camera, each colour image with its timestamp drawn into it.
class ClockCamera : public CameraSource {
 public:
  explicit ClockCamera(std::unique_ptr<CameraSource> camera) : camera_(std::move(camera)) {}

  Status read(CameraImage& image, std::chrono::milliseconds timeout) override {
    const Status status = camera_->read(image, timeout);
    if (status == Status::image && image.sensor == Sensor::color) {
      draw_clock_code(clock_ticks(image.stamp_s), image.color);
    }
    return status;
  }
  std::size_t dropped() const override { return camera_->dropped(); }

 private:
  std::unique_ptr<CameraSource> camera_;
};

const bool clock_camera_registered = Registry<CameraSource>::add(
    "clock", {.open =
                  [](const CameraUri& uri, const CameraRequest& request) {
                    return std::make_unique<ClockCamera>(open_camera(uri.target, request));
                  },
              .list = {},
              .help = "clock:CAMERA  another camera with the time drawn into its pictures",
              .free_text = true});

}  // namespace
}  // namespace diminish
