#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <thread>

#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "source/find_camera.h"
#include "source/image_stream.h"

namespace diminish {
namespace {

/// A looped sensor's images are kept after the first lap if they are not more than this.
constexpr double max_kept_bytes = 3e8;

/// When a recording's images are due.
struct Timeline {
  double epoch_s = 0;  ///< of the recording's first colour image, on the monotonic clock
  double first_s = 0;  ///< that image's timestamp
  double lap_s = 0;    ///< how long the recording is
  double rate = 1;

  /// Laps begin at whole multiples of their length, so that all processes of this machine show the
  /// same moment.
  void keep_in_step() {
    const double length_s = lap_s / rate;
    epoch_s = std::floor(epoch_s / length_s) * length_s;
  }
  double due_s(double stamp_s, std::size_t lap) const {
    return epoch_s + (stamp_s - first_s + static_cast<double>(lap) * lap_s) / rate;
  }
};

Image<Bgr>& pixels(CameraImage& image, Bgr) {
  return image.color;
}
Image<std::uint16_t>& pixels(CameraImage& image, std::uint16_t) {
  return image.depth;
}

/// One sensor's images, each when it is due.
template <class Pixel>
class Replay {
 public:
  Replay(const std::filesystem::path& list, const Intrinsics& sensor, const Timeline& timeline,
         bool loop, EmptyList empty = EmptyList::is_error)
      : stream_(list, sensor, empty), timeline_(timeline), loop_(loop) {
    const auto count = static_cast<double>(stream_.entries().size());
    period_s_ = median_period_s(stream_.entries()) / timeline.rate;
    if (loop && count * sensor.width * sensor.height * sizeof(Pixel) <= max_kept_bytes) {
      kept_.resize(stream_.entries().size());
    }
  }

  bool is_over() const {
    return stream_.entries().empty() || (!loop_ && next_ >= stream_.entries().size());
  }
  double due_s() const {
    const std::size_t count = stream_.entries().size();
    return timeline_.due_s(stream_.entries()[next_ % count].stamp_s, next_ / count);
  }

  /// Images that were due long ago are left out, as a camera's driver does, unless they are decoded
  /// already.
  std::size_t skip_late(double now_s) {
    const std::size_t before = next_;
    while (!is_over() && prepared_ != next_ && due_s() + 2 * period_s_ < now_s) ++next_;
    return next_ - before;
  }

  /// Decodes the next image ahead of its time.
  void prepare() {
    if (is_over() || prepared_ == next_) return;
    prepared_ = next_;
    fault_.clear();
    const std::size_t index = next_ % stream_.entries().size();
    Image<Pixel>* const kept = kept_.empty() ? nullptr : &kept_[index];
    if (kept && !kept->empty()) {
      image_ = *kept;
      return;
    }
    try {
      stream_.read(index, image_);
      if (kept) *kept = image_;
    } catch (const Error& error) {
      fault_ = error.what();
    }
  }

  void take(CameraImage& image) {
    image.stamp_s = due_s();
    std::swap(pixels(image, Pixel{}), image_);
    image.fault = fault_;
    ++next_;
  }

 private:
  ImageStream<Pixel> stream_;
  Timeline timeline_;
  bool loop_;
  double period_s_ = 0;
  std::size_t next_ = 0;
  std::optional<std::size_t> prepared_;  ///< which image `image_` is
  Image<Pixel> image_;
  std::string fault_;
  std::vector<Image<Pixel>> kept_;
};

/// A recording's camera in real time, as if live.
class RecordingCamera : public CameraSource {
 public:
  RecordingCamera(const CameraUri& uri, const CameraRequest& request) {
    uri.expect_parameters({"loop", "rate", "camera", "in-step"});
    const std::filesystem::path folder = uri.target;
    const Rig rig = load_rig(folder / "rig.yaml");
    const bool loop = uri.has("loop");
    const auto color = load_stream_list(folder / "color.txt");
    Timeline timeline{request.epoch_s, color.front().stamp_s,
                      color.back().stamp_s - color.front().stamp_s + median_period_s(color),
                      uri.number("rate", 1, 0.01, 100)};
    if (uri.has("in-step")) timeline.keep_in_step();
    const std::string name = uri.text_of("camera", request.name);
    if (name == "color") {
      color_.emplace(folder / "color.txt", rig.color, timeline, loop);
      begin();
      return;
    }
    const RgbdCamera* camera = find_rgbd_camera(rig, name);
    if (!camera) uri.fail("the recording has no camera '" + name + "'");
    color_.emplace(folder / (name + "_color.txt"), camera->color, timeline, loop,
                   EmptyList::is_no_images);
    if (camera->measures_depth && !is_ignored(request)) {
      depth_.emplace(folder / (name + "_depth.txt"), camera->depth, timeline, loop,
                     EmptyList::is_no_images);
    }
    begin();
  }

  Status read(CameraImage& image, std::chrono::milliseconds timeout) override {
    const double now_s = monotonic_now_s();
    dropped_ += color_->skip_late(now_s);
    if (depth_) dropped_ += depth_->skip_late(now_s);
    const bool has_color = !color_->is_over();
    const bool has_depth = depth_ && !depth_->is_over();
    if (!has_color && !has_depth) return Status::end;
    color_->prepare();
    if (depth_) depth_->prepare();
    const bool is_depth = has_depth && (!has_color || depth_->due_s() < color_->due_s());
    const double wait_s = (is_depth ? depth_->due_s() : color_->due_s()) - monotonic_now_s();
    const double most_s = std::chrono::duration<double>(timeout).count();
    if (wait_s > 0)
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(wait_s, most_s)));
    if (wait_s > most_s) return Status::nothing;
    image.sensor = is_depth ? Sensor::depth : Sensor::color;
    if (is_depth) {
      depth_->take(image);
    } else {
      color_->take(image);
    }
    return Status::image;
  }

  std::size_t dropped() const override { return dropped_; }

 private:
  /// Whether the session wants no depth of this camera.
  static bool is_ignored(const CameraRequest& request) {
    if (request.rig == nullptr) return false;
    const RgbdCamera* const wanted = find_rgbd_camera(*request.rig, request.name);
    return wanted != nullptr && !wanted->measures_depth;
  }

  /// What was due before it was opened, maybe again, is not dropped.
  void begin() {
    const double now_s = monotonic_now_s();
    color_->skip_late(now_s);
    if (depth_) depth_->skip_late(now_s);
  }

  std::optional<Replay<Bgr>> color_;
  std::optional<Replay<std::uint16_t>> depth_;
  std::size_t dropped_ = 0;
};

const bool recording_camera_registered = Registry<CameraSource>::add(
    "recording", {.open =
                      [](const CameraUri& uri, const CameraRequest& request) {
                        return std::make_unique<RecordingCamera>(uri, request);
                      },
                  .list = {},
                  .help = "recording:FOLDER?loop&rate=1  a recording, replayed in real time"});

}  // namespace
}  // namespace diminish
