#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "diminish/error.h"
#include "fuzzed_folder.h"
#include "setup/repair/recording_repair.h"

/// What is repaired need not be repaired again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  static FuzzedFolder folder;
  folder.fill(data, size);
  try {
    repair_recording(folder.path());
  } catch (const Error&) {
    return 0;
  }
  if (repair_recording(folder.path()).was_needed()) std::abort();
  return 0;
}
