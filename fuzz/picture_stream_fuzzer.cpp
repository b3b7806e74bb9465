#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "diminish/error.h"
#include "serve/picture_stream.h"

/// Any bytes are pictures, however they are cut, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  const auto* const bytes = reinterpret_cast<const char*>(data);
  const auto bytes_of_pictures = [&](std::size_t piece) {
    PictureStream stream;
    std::size_t total = 0;
    try {
      for (std::size_t begin = 0; begin < size; begin += piece) {
        stream.feed(bytes + begin, std::min(piece, size - begin));
        while (const auto picture = stream.next()) total += picture->jpeg.size() + 1;
      }
    } catch (const Error&) {
    }
    return total;
  };
  const std::size_t whole = bytes_of_pictures(size + 1);
  if (whole > 2 * size || bytes_of_pictures(7) != whole) std::abort();
  return 0;
}
