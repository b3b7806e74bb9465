#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "diminish/error.h"
#include "source/stream_list.h"

/// Any bytes are either a list whose entries can be found by their timestamps, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
  try {
    const auto entries = read_stream_list(stream, "fuzz.txt");
    for (std::size_t i = 0; i < entries.size(); ++i) {
      if (nearest_entry(entries, entries[i].stamp_s, 0) != i) std::abort();
      entry_name(entries[i], i);
    }
    median_period_s(entries);
  } catch (const Error&) {
  }
  return 0;
}
