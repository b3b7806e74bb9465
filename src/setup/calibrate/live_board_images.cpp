#include "setup/calibrate/live_board_images.h"

#include <fmt/format.h>

#include <utility>

#include "diminish/error.h"

namespace diminish {
namespace {

constexpr double longest_silence_s = 5;
/// Images older than this waited while the last one was processed.
constexpr double newest_s = 0.1;

}  // namespace

LiveBoardImages::LiveBoardImages(const std::string& uri, double seconds)
    : uri_(uri),
      begin_s_(monotonic_now_s()),
      seconds_(seconds),
      camera_(open_camera(uri, {.name = "color", .rig = nullptr, .epoch_s = begin_s_})) {}

bool LiveBoardImages::next() {
  const double asked_s = monotonic_now_s();
  for (double now_s = asked_s; now_s - begin_s_ < seconds_; now_s = monotonic_now_s()) {
    const auto status = camera_->read(image_, std::chrono::milliseconds(100));
    if (status == CameraSource::Status::end) return false;
    const bool is_color = status == CameraSource::Status::image && image_.sensor == Sensor::color;
    if (is_color && image_.stamp_s > asked_s - newest_s) return true;
    if (!is_color && now_s - asked_s > longest_silence_s) {
      throw Error(Error::device,
                  fmt::format("{}: no colour image for {} s", uri_, longest_silence_s));
    }
  }
  return false;
}

std::string LiveBoardImages::name() const {
  return fmt::format("{:.1f} s", image_.stamp_s - begin_s_);
}

void LiveBoardImages::read(Image<Bgr>& image) {
  if (!image_.fault.empty()) throw Error(Error::input, image_.fault);
  std::swap(image, image_.color);
}

}  // namespace diminish
