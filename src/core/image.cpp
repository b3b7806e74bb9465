#include "diminish/image.h"

#include "core/bounding_box.h"

namespace diminish {
namespace {

/// As many as a byte can count at a time, so that the compiler takes many pixels at a time.
template <class Predicate>
std::size_t count_if(const Image<std::uint8_t>& image, const Rect& part,
                     const Predicate& predicate) {
  constexpr int most = 255;
  std::size_t count = 0;
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int begin = part.x; begin < part.right(); begin += most) {
      const std::uint8_t* const row = image.row(y);
      const int end = std::min(begin + most, part.right());
      std::uint8_t in_bytes = 0;
      for (int x = begin; x < end; ++x) {
        in_bytes = static_cast<std::uint8_t>(in_bytes + (predicate(row[x]) ? 1 : 0));
      }
      count += in_bytes;
    }
  }
  return count;
}

}  // namespace

Rect bounding_box(const Mask& mask) {
  return bounding_box(mask, mask.bounds());
}

Rect bounding_box(const Mask& mask, const Rect& part) {
  return bounding_box(mask.data(), mask.width(), part);
}

std::size_t count_equal(const Image<std::uint8_t>& image, std::uint8_t value, const Rect& part) {
  return count_if(image, part, [value](std::uint8_t pixel) { return pixel == value; });
}

std::size_t count_nonzero(const Mask& mask, const Rect& part) {
  return count_if(mask, part, [](std::uint8_t pixel) { return pixel != 0; });
}

}  // namespace diminish
