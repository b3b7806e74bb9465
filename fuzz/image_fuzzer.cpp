#include <cstddef>
#include <cstdint>
#include <vector>

#include "diminish/error.h"
#include "source/image_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> bytes(data, data + size);
  try {
    diminish::decode<diminish::Bgr>(bytes);
  } catch (const diminish::Error&) {
  }
  try {
    diminish::decode<std::uint16_t>(bytes);
  } catch (const diminish::Error&) {
  }
  return 0;
}
