#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "detect/color_blob/color_model.h"
#include "diminish/error.h"
#include "fuzzed_folder.h"

/// Any training folder, with or without a model file, is a colour that can be compared, or an
/// Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  static FuzzedFolder folder;
  folder.fill(data, size);
  for (const auto learn : {load_color_model, train_color_model}) {
    try {
      const ColorDeviation deviation = learn(folder.path()).deviation({12, 200, 90});
      if (std::isnan(deviation.tint) || std::isnan(deviation.value)) std::abort();
    } catch (const Error&) {
    }
  }
  return 0;
}
