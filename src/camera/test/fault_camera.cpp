#include <fmt/format.h>

#include <atomic>
#include <random>
#include <thread>

#include "diminish/camera_source.h"
#include "diminish/error.h"

namespace diminish {
namespace {

constexpr double longest_stall_s = 60;
/// How far a clock is set back. The next time it is set right.
constexpr double clock_error_s = 3;

/// The probabilities, an image each, of what goes wrong. resize: at each opening, that all images
/// have half the size.
struct Faults {
  double drop, duplicate, disorder, wrong_size, torn, stall, unplug, clock, resize;
  double stall_s;
};

/// Another camera with faults: to see whether a set-up, or this program, bears them.
class FaultCamera : public CameraSource {
 public:
  FaultCamera(const CameraUri& settings, const std::string& uri, const CameraRequest& request)
      : faults_{probability(settings, "drop"),
                probability(settings, "duplicate"),
                probability(settings, "disorder"),
                probability(settings, "wrong_size"),
                probability(settings, "torn"),
                probability(settings, "stall"),
                probability(settings, "unplug"),
                probability(settings, "clock"),
                probability(settings, "resize"),
                settings.number("stall_s", 1.5, 0, longest_stall_s)} {
    settings.expect_parameters({"seed", "drop", "duplicate", "disorder", "wrong_size", "torn",
                                "stall", "stall_s", "unplug", "clock", "resize"});
    static std::atomic<unsigned> openings = 0;
    const unsigned opening = openings++;
    random_.seed(static_cast<unsigned>(settings.number("seed", 1, 0, 1e9)) + opening);
    if (faults_.unplug > 0 && opening % 3 == 1) settings.fail("unplugged", Error::device);
    is_resized_ = happens(faults_.resize);
    camera_ = open_camera(uri, request);
  }

  Status read(CameraImage& image, std::chrono::milliseconds timeout) override {
    const Status status = camera_->read(image, timeout);
    if (status != Status::image) return status;
    if (happens(faults_.unplug)) throw Error(Error::device, "unplugged");
    if (happens(faults_.stall)) {
      std::this_thread::sleep_for(std::chrono::duration<double>(faults_.stall_s));
    }
    if (happens(faults_.drop)) {
      ++dropped_;
      return Status::nothing;
    }
    double& last_stamp_s = last_stamps_s_[image.sensor == Sensor::depth ? 1 : 0];
    if (happens(faults_.clock)) clock_error_s_ = clock_error_s_ == 0 ? -clock_error_s : 0;
    image.stamp_s += clock_error_s_;
    if (happens(faults_.duplicate) && last_stamp_s > 0) image.stamp_s = last_stamp_s;
    if (happens(faults_.disorder)) image.stamp_s -= 0.2;
    last_stamp_s = std::max(last_stamp_s, image.stamp_s);
    if (happens(faults_.torn)) image.fault = "torn image";
    if (happens(faults_.wrong_size)) {
      image.color.resize(16, 12);
      image.depth.resize(16, 12);
    }
    if (is_resized_) {
      image.color.resize(image.color.width() / 2, image.color.height() / 2);
      image.depth.resize(image.depth.width() / 2, image.depth.height() / 2);
    }
    return Status::image;
  }

  std::size_t dropped() const override { return camera_->dropped() + dropped_; }

 private:
  static double probability(const CameraUri& settings, const char* key) {
    return settings.number(key, 0, 0, 1);
  }
  bool happens(double probability) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < probability;
  }

  Faults faults_;
  std::unique_ptr<CameraSource> camera_;
  std::mt19937 random_;
  std::array<double, 2> last_stamps_s_{};
  double clock_error_s_ = 0;
  bool is_resized_ = false;
  std::size_t dropped_ = 0;
};

const bool fault_camera_registered = Registry<CameraSource>::add(
    "faults",
    {.open =
         [](const CameraUri& uri, const CameraRequest& request) {
           const std::size_t end = uri.target.find(';');
           if (end == std::string::npos) {
             uri.fail("expected faults:drop=0.1&stall=0.01;CAMERA");
           }
           CameraUri settings = parse_camera_uri("settings:?" + uri.target.substr(0, end));
           settings.text = uri.text;
           return std::make_unique<FaultCamera>(settings, uri.target.substr(end + 1), request);
         },
     .list = {},
     .help = "faults:drop=0.1&stall=0.01;CAMERA  another camera, with faults, for trials",
     .free_text = true});

}  // namespace
}  // namespace diminish
