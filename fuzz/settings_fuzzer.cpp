#include <cstddef>
#include <cstdint>
#include <string>

#include "diminish/error.h"
#include "serve/settings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const diminish::Settings settings =
        diminish::changed_settings({}, std::string(reinterpret_cast<const char*>(data), size));
    diminish::check(settings.options);
  } catch (const diminish::Error&) {
  }
  return 0;
}
