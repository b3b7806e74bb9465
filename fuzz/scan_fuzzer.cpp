#include <cstddef>
#include <cstdint>

#include "diminish/error.h"
#include "diminish/pipeline.h"
#include "diminish/scan.h"
#include "fuzzed_folder.h"
#include "small_cameras.h"

/// Any folder is a scan that can be a background, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  static FuzzedFolder folder;
  folder.fill(data, size);
  try {
    const Scan scan = load_scan(folder.path());
    if (!has_small_cameras(scan.rig) || scan.frames.empty()) return 0;
    Pipeline pipeline(scan.rig, scan.scene, {});
    pipeline.set_background(scan);
    DiminishedFrame result;
    pipeline.process(scan.frames.front().frame, result);
  } catch (const Error&) {
  }
  return 0;
}
