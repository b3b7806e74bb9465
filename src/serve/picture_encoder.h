#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "diminish/live.h"

namespace diminish {

/// Which picture of a frame: the result, the camera's, or both with the camera's on top.
enum class View { after, before, pair };
inline constexpr std::array<const char*, 3> view_names = {"after", "before", "pair"};

/// Throws Error for an unknown view.
View parse_view(const std::string& name);

/// Compresses each picture once for all viewers.
class PictureEncoder {
 public:
  explicit PictureEncoder(int jpeg_quality) : jpeg_quality_(jpeg_quality) {}

  using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;

  /// Callers must pass frames in the order in which they were made; older ones are compressed
  /// again.
  Bytes jpeg(const LiveFrame& frame, View view);
  /// Lossless; not kept.
  std::vector<std::uint8_t> png(const LiveFrame& frame, View view) const;

 private:
  struct Kept {
    std::mutex mutex;
    std::size_t number = 0;  ///< the frame's
    Bytes bytes;
    Image<Bgr> stacked;
  };

  int jpeg_quality_;
  std::array<Kept, view_names.size()> kept_;
};

}  // namespace diminish
