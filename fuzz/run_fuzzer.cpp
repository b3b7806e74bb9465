#include <cstddef>
#include <cstdint>

#include "diminish/error.h"
#include "diminish/report.h"
#include "fuzzed_folder.h"

/// Any folders, recording/ and run/, are results that can be reported on and compared, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  static FuzzedFolder folder;
  folder.fill(data, size);
  const auto recording = folder.path() / "recording";
  const auto run = folder.path() / "run";
  const auto page = folder.path() / "page.html";
  try {
    write_report(recording, run, page);
  } catch (const Error&) {
  }
  try {
    write_comparison(recording, run, run, page);
  } catch (const Error&) {
  }
  return 0;
}
