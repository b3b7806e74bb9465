#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "diminish/error.h"
#include "pose/pose_list.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  try {
    diminish::read_pose_list(stream, "poses.txt");
  } catch (const diminish::Error&) {
  }
  return 0;
}
