#include <cstddef>
#include <cstdint>
#include <string>

#include "diminish/camera_source.h"
#include "diminish/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const diminish::CameraUri uri =
        diminish::parse_camera_uri(std::string(reinterpret_cast<const char*>(data), size));
    uri.number("rate", 1, 0, 100);
    uri.expect_parameters({"rate", "loop"});
  } catch (const diminish::Error&) {
  }
  return 0;
}
