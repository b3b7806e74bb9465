// An OpenNI2 driver, loaded by the real library as any other, whose one device serves a recording:
// what DIMINISH_TEST_RECORDING names, its RGB-D camera rgbd0, again and again at 30 images a
// second.

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include "diminish/frame_source.h"

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

namespace {

using oni::driver::DeviceBase;
using oni::driver::DriverBase;
using oni::driver::StreamBase;

constexpr const char* device_uri = "test-recording";
constexpr int frames_per_second = 30;

OniVideoMode mode_of(const diminish::Intrinsics& sensor, OniPixelFormat format) {
  return {format, sensor.width, sensor.height, frames_per_second};
}

/// One sensor's images, already in the driver's pixel format.
struct SensorImages {
  OniVideoMode mode;
  std::vector<std::vector<char>> images;
  int bytes_per_pixel = 0;
};

class RecordingStream : public StreamBase {
 public:
  explicit RecordingStream(const SensorImages& sensor) : sensor_(sensor) {}
  ~RecordingStream() override { RecordingStream::stop(); }

  OniStatus start() override {
    running_ = true;
    thread_ = std::thread([this] { deliver(); });
    return ONI_STATUS_OK;
  }
  void stop() override {
    running_ = false;
    if (thread_.joinable()) thread_.join();
  }
  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV ||
           id == ONI_STREAM_PROPERTY_VERTICAL_FOV;
  }
  int getRequiredFrameSize() override { return static_cast<int>(sensor_.images.front().size()); }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE) return give(sensor_.mode, data, size);
    if (!isPropertySupported(id)) return ONI_STATUS_NOT_IMPLEMENTED;
    const float angle = id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV ? 1.0F : 0.8F;
    return give(angle, data, size);
  }
  OniStatus setProperty(int id, const void*, int) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE ? ONI_STATUS_OK : ONI_STATUS_NOT_IMPLEMENTED;
  }

 private:
  template <class Value>
  static OniStatus give(const Value& value, void* data, int* size) {
    if (*size != static_cast<int>(sizeof value)) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, &value, sizeof value);
    return ONI_STATUS_OK;
  }

  void deliver() {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    for (int i = 0; running_; ++i) {
      const auto due = std::chrono::microseconds(1000000LL * i / frames_per_second);
      std::this_thread::sleep_until(start + due);
      OniFrame* frame = getServices().acquireFrame();
      if (!frame) continue;
      const auto& image = sensor_.images[static_cast<std::size_t>(i) % sensor_.images.size()];
      frame->frameIndex = i;
      frame->videoMode = sensor_.mode;
      frame->width = sensor_.mode.resolutionX;
      frame->height = sensor_.mode.resolutionY;
      frame->stride = frame->width * sensor_.bytes_per_pixel;
      frame->timestamp = static_cast<std::uint64_t>(due.count());
      frame->sensorType = sensor_.bytes_per_pixel == 2 ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR;
      frame->croppingEnabled = FALSE;
      frame->cropOriginX = frame->cropOriginY = 0;
      frame->dataSize = static_cast<int>(image.size());
      std::memcpy(frame->data, image.data(), image.size());
      raiseNewFrame(frame);
      getServices().releaseFrame(frame);
    }
  }

  const SensorImages& sensor_;
  std::atomic<bool> running_ = false;
  std::thread thread_;
};

class RecordingDevice : public DeviceBase {
 public:
  RecordingDevice() {
    const auto recording = diminish::load_recording(std::getenv("DIMINISH_TEST_RECORDING"));
    const diminish::RgbdCamera& camera = recording.rig.rgbd.at(0);
    color_.mode = mode_of(camera.color, ONI_PIXEL_FORMAT_RGB888);
    color_.bytes_per_pixel = 3;
    depth_.mode = mode_of(camera.depth, ONI_PIXEL_FORMAT_DEPTH_1_MM);
    depth_.bytes_per_pixel = 2;
    const auto source = diminish::open_recording(recording, {});
    for (diminish::FrameSet frame; source->next(frame);) {
      std::vector<char>& rgb = color_.images.emplace_back();
      for (const diminish::Bgr& pixel : frame.rgbd[0].color.own()) {
        for (const std::uint8_t value : {pixel.r, pixel.g, pixel.b}) {
          rgb.push_back(static_cast<char>(value));
        }
      }
      const auto& depth = frame.rgbd[0].depth.own();
      const char* bytes = reinterpret_cast<const char*>(depth.data());
      depth_.images.emplace_back(bytes, bytes + depth.size() * sizeof(std::uint16_t));
    }
    sensors_[0] = {ONI_SENSOR_DEPTH, 1, &depth_.mode};
    sensors_[1] = {ONI_SENSOR_COLOR, 1, &color_.mode};
  }
  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_;
    *count = 2;
    return ONI_STATUS_OK;
  }
  StreamBase* createStream(OniSensorType type) override {
    return new RecordingStream(type == ONI_SENSOR_DEPTH ? depth_ : color_);
  }
  void destroyStream(StreamBase* stream) override { delete stream; }

 private:
  SensorImages color_, depth_;
  OniSensorInfo sensors_[2]{};
};

class RecordingDriver : public DriverBase {
 public:
  explicit RecordingDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    OniDeviceInfo info{};
    std::strncpy(info.uri, device_uri, sizeof info.uri - 1);
    std::strncpy(info.vendor, "diminish", sizeof info.vendor - 1);
    std::strncpy(info.name, "recording", sizeof info.name - 1);
    deviceConnected(&info);
    deviceStateChanged(&info, 0);
    return ONI_STATUS_OK;
  }
  DeviceBase* deviceOpen(const char*, const char*) override {
    try {
      return new RecordingDevice();
    } catch (const std::exception&) {
      return nullptr;
    }
  }
  void deviceClose(DeviceBase* device) override { delete device; }
  void shutdown() override {}
};

}  // namespace

ONI_EXPORT_DRIVER(RecordingDriver)
