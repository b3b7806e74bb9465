#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "detect/articulated/joint_list.h"
#include "diminish/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  try {
    std::vector<double> positions;
    diminish::JointList::read(stream, "angles.txt", 2).at(1, 0.5, positions);
  } catch (const diminish::Error&) {
  }
  return 0;
}
