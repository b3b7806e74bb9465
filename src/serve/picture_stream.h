#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace diminish {

/// Splits /api/stream.mjpg (multipart/x-mixed-replace) into pictures as its bytes arrive.
class PictureStream {
 public:
  struct Picture {
    std::size_t frame = 0;  ///< its number
    std::vector<std::uint8_t> jpeg;
  };

  void feed(const char* data, std::size_t size) { waiting_.append(data, size); }
  /// The next picture, once it is complete. Throws Error if this is not such a stream.
  std::optional<Picture> next();

 private:
  std::string waiting_;
};

}  // namespace diminish
