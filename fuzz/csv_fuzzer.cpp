#include <cstddef>
#include <cstdint>
#include <string>

#include "diminish/error.h"
#include "score/csv_table.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    diminish::parse_csv(std::string(reinterpret_cast<const char*>(data), size), "frames.csv");
  } catch (const diminish::Error&) {
  }
  return 0;
}
