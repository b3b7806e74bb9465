// How old a camera's images are when a session gets them: of a local camera, and of the same one
// over a wire (docs/many-machines.md).
//   diminish_camera_age RECORDING NAME SECONDS URI...    each URI in turn; the camera is NAME in
//   the rig

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "diminish/camera_source.h"
#include "diminish/rig.h"

namespace diminish {
namespace {

void measure(const std::string& uri, const std::string& name, const Rig& rig, double seconds) {
  const auto camera = open_camera(uri, {name, &rig, monotonic_now_s()});
  CameraImage image;
  std::vector<double> ages_ms[2];
  double first_s = 0;
  for (double end_s = monotonic_now_s() + seconds + 5; monotonic_now_s() < end_s;) {
    if (camera->read(image, std::chrono::milliseconds(100)) != CameraSource::Status::image)
      continue;
    const double now_s = monotonic_now_s();
    // What comes before it has settled is left out.
    if (first_s == 0) {
      first_s = now_s + 1;
      end_s = first_s + seconds;
    }
    if (now_s < first_s || !image.fault.empty()) continue;
    ages_ms[image.sensor == Sensor::color ? 0 : 1].push_back((now_s - image.stamp_s) * 1e3);
  }
  for (std::size_t sensor = 0; sensor < 2; ++sensor) {
    std::vector<double>& ages = ages_ms[sensor];
    if (ages.empty()) continue;
    std::sort(ages.begin(), ages.end());
    fmt::print("{:<6} {:>5.1f} images/s, median {:.2f}, 95 % {:.2f} ms, dropped {}  {}\n",
               sensor == 0 ? "colour" : "depth", static_cast<double>(ages.size()) / seconds,
               ages[ages.size() / 2], ages[ages.size() * 95 / 100], camera->dropped(), uri);
  }
}

}  // namespace
}  // namespace diminish

int main(int count, char** arguments) {
  if (count < 5) return 2;
  try {
    const diminish::Rig rig = diminish::load_rig(std::string(arguments[1]) + "/rig.yaml");
    for (int i = 4; i < count; ++i) {
      diminish::measure(arguments[i], arguments[2], rig, std::atof(arguments[3]));
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
