#include <cstddef>
#include <cstdint>
#include <string_view>

#include "diminish/error.h"
#include "setup/convert/kinect_calibration.h"

using namespace diminish;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view json(reinterpret_cast<const char*>(data), size);
  for (const cv::Size depth : {cv::Size(640, 576), cv::Size(512, 512)}) {
    try {
      const auto calibration = read_kinect_calibration(json, {1920, 1080}, depth);
      Lens(calibration.depth).undistort({0, 0});
      Lens(calibration.color).undistort({0, 0});
    } catch (const Error&) {
    }
  }
  return 0;
}
