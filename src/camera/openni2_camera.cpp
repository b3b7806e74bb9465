#include <OpenNI.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

std::string last_error() {
  std::string text = openni::OpenNI::getExtendedError();
  for (char& c : text) c = c == '\n' || c == '\t' ? ' ' : c;
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return "OpenNI2 gives no reason";
  return text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

/// OpenNI2, as long as somebody uses it.
class Library {
 public:
  Library() {
    const std::lock_guard lock(mutex());
    if (users()++ > 0) return;
    if (openni::OpenNI::initialize() == openni::STATUS_OK) return;
    const std::string reason = last_error();
    --users();
    throw Error(Error::device, "OpenNI2 does not start: " + reason);
  }
  ~Library() {
    const std::lock_guard lock(mutex());
    if (--users() == 0) openni::OpenNI::shutdown();
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  static int& users() {
    static int count = 0;
    return count;
  }
};

/// A sensor's frames with their times brought to the monotonic clock. The driver's clock is its
/// own: the image that was on its way shortest says how far the two are apart.
class SensorStream {
 public:
  /// sensor: whose size the images must have; null: any.
  SensorStream(const CameraUri& uri, openni::Device& device, openni::SensorType type,
               const Intrinsics* sensor) {
    const char* name = type == openni::SENSOR_DEPTH ? "depth" : "colour";
    if (stream_.create(device, type) != openni::STATUS_OK) {
      uri.fail(fmt::format("no {} sensor: {}", name, last_error()), Error::device);
    }
    choose_mode(uri, type, sensor, name);
    stream_.setMirroringEnabled(false);
    if (stream_.start() != openni::STATUS_OK) {
      uri.fail(fmt::format("the {} sensor does not start: {}", name, last_error()), Error::device);
    }
  }
  ~SensorStream() {
    stream_.stop();
    stream_.destroy();
  }
  SensorStream(const SensorStream&) = delete;
  SensorStream& operator=(const SensorStream&) = delete;

  openni::VideoStream* stream() { return &stream_; }

  std::optional<Intrinsics> intrinsics() const {
    const double width_angle = stream_.getHorizontalFieldOfView();
    const double height_angle = stream_.getVerticalFieldOfView();
    if (!(width_angle > 0) || !(height_angle > 0)) return std::nullopt;
    const openni::VideoMode mode = stream_.getVideoMode();
    const int width = mode.getResolutionX();
    const int height = mode.getResolutionY();
    return Intrinsics{.width = width,
                      .height = height,
                      .fx = width / (2 * std::tan(width_angle / 2)),
                      .fy = height / (2 * std::tan(height_angle / 2)),
                      .cx = (width - 1) / 2.0,
                      .cy = (height - 1) / 2.0};
  }

  void read(CameraImage& image) {
    if (stream_.readFrame(&frame_) != openni::STATUS_OK) throw Error(Error::device, last_error());
    const double now_s = monotonic_now_s();
    const double driver_s = static_cast<double>(frame_.getTimestamp()) * 1e-6;
    clock_offset_s_ = std::min(clock_offset_s_, now_s - driver_s);
    image.stamp_s = driver_s + clock_offset_s_;
    image.fault.clear();
    switch (frame_.getVideoMode().getPixelFormat()) {
      case openni::PIXEL_FORMAT_RGB888:
        image.sensor = Sensor::color;
        return copy_rows<openni::RGB888Pixel>(image.color, [](const openni::RGB888Pixel& p) {
          return Bgr{p.b, p.g, p.r};
        });
      case openni::PIXEL_FORMAT_DEPTH_1_MM:
      case openni::PIXEL_FORMAT_DEPTH_100_UM:
        image.sensor = Sensor::depth;
        return copy_rows<openni::DepthPixel>(image.depth,
                                             [](openni::DepthPixel depth) { return depth; });
      default:
        image.fault = "expected RGB or depth pixels";
    }
  }

 private:
  void choose_mode(const CameraUri& uri, openni::SensorType type, const Intrinsics* sensor,
                   const char* name) {
    const auto is_usable = [&](const openni::VideoMode& mode) {
      return type == openni::SENSOR_DEPTH || mode.getPixelFormat() == openni::PIXEL_FORMAT_RGB888;
    };
    if (!sensor && is_usable(stream_.getVideoMode())) return;
    const auto& modes = stream_.getSensorInfo().getSupportedVideoModes();
    std::string sizes;
    for (int i = 0; i < modes.getSize(); ++i) {
      const openni::VideoMode& mode = modes[i];
      sizes += fmt::format(" {}x{}", mode.getResolutionX(), mode.getResolutionY());
      const bool has_size = !sensor || (mode.getResolutionX() == sensor->width &&
                                        mode.getResolutionY() == sensor->height);
      if (!is_usable(mode) || !has_size) continue;
      // A file's only mode cannot be set.
      if (stream_.setVideoMode(mode) == openni::STATUS_OK || modes.getSize() == 1) return;
    }
    const std::string wanted =
        sensor ? fmt::format("of the rig's {}x{}", sensor->width, sensor->height) : "in RGB";
    uri.fail(fmt::format("the {} sensor has no mode {}, only{}", name, wanted, sizes));
  }

  template <class DriverPixel, class Pixel, class Convert>
  void copy_rows(Image<Pixel>& image, Convert convert) {
    image.resize(frame_.getWidth(), frame_.getHeight());
    const auto* bytes = static_cast<const std::uint8_t*>(frame_.getData());
    for (int y = 0; y < image.height(); ++y) {
      const auto* row = reinterpret_cast<const DriverPixel*>(
          bytes +
          static_cast<std::size_t>(y) * static_cast<std::size_t>(frame_.getStrideInBytes()));
      std::transform(row, row + image.width(), image.row(y), convert);
    }
  }

  openni::VideoStream stream_;
  openni::VideoFrameRef frame_;
  double clock_offset_s_ = std::numeric_limits<double>::infinity();
};

/// A depth camera, or a file, through OpenNI2: one of its drivers, which it loads as plugins.
class OpenNi2Camera : public CameraSource {
 public:
  OpenNi2Camera(const CameraUri& uri, const CameraRequest& request) {
    uri.expect_parameters({"color"});
    const RgbdCamera* camera = request.rig ? find_rgbd_camera(*request.rig, request.name) : nullptr;
    if (request.rig && !camera) uri.fail("expected to be used for an RGB-D camera");
    const char* device_uri = uri.target.empty() ? openni::ANY_DEVICE : uri.target.c_str();
    if (device_.open(device_uri) != openni::STATUS_OK) uri.fail(last_error(), Error::device);
    depth_.emplace(uri, device_, openni::SENSOR_DEPTH, camera ? &camera->depth : nullptr);
    // "color=no": another device has the colour sensor.
    if (uri.text_of("color", "yes") != "no") {
      color_.emplace(uri, device_, openni::SENSOR_COLOR, camera ? &camera->color : nullptr);
    }
  }
  ~OpenNi2Camera() override {
    depth_.reset();
    color_.reset();
    device_.close();
  }

  Status read(CameraImage& image, std::chrono::milliseconds timeout) override {
    std::array<openni::VideoStream*, 2> streams = {depth_->stream(),
                                                   color_ ? color_->stream() : nullptr};
    int ready = 0;
    const openni::Status status = openni::OpenNI::waitForAnyStream(
        streams.data(), color_ ? 2 : 1, &ready, static_cast<int>(timeout.count()));
    if (status == openni::STATUS_TIME_OUT) {
      if (!device_.isValid()) throw Error(Error::device, "the device is gone");
      return Status::nothing;
    }
    if (status != openni::STATUS_OK) throw Error(Error::device, last_error());
    (ready == 0 ? *depth_ : *color_).read(image);
    return Status::image;
  }

  std::optional<Intrinsics> intrinsics(Sensor sensor) const override {
    if (sensor == Sensor::depth) return depth_->intrinsics();
    return color_ ? color_->intrinsics() : std::nullopt;
  }

 private:
  Library library_;
  openni::Device device_;
  std::optional<SensorStream> depth_, color_;
};

std::vector<CameraDevice> list_devices() {
  const Library library;
  openni::Array<openni::DeviceInfo> found;
  openni::OpenNI::enumerateDevices(&found);
  std::vector<CameraDevice> devices;
  for (int i = 0; i < found.getSize(); ++i) {
    devices.push_back({std::string("openni2:") + found[i].getUri(),
                       std::string(found[i].getVendor()) + " " + found[i].getName()});
  }
  return devices;
}

const bool openni2_camera_registered = Registry<CameraSource>::add(
    "openni2",
    {.open =
         [](const CameraUri& uri, const CameraRequest& request) {
           return std::make_unique<OpenNi2Camera>(uri, request);
         },
     .list = list_devices,
     .help = "openni2:URI or openni2:FILE.oni  a depth camera; without URI the first one"});

}  // namespace
}  // namespace diminish
