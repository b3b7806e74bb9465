#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "diminish/live.h"

namespace diminish {

/// What of a frame is shown: the result, the camera's picture, or both, the latter on top.
enum class View { after, before, pair };
inline constexpr std::array<const char*, 3> view_names = {"after", "before", "pair"};

/// Throws Error if there is no such view.
View parse_view(const std::string& name);

/// Compresses pictures, each once for everybody.
class PictureEncoder {
 public:
  explicit PictureEncoder(int jpeg_quality) : jpeg_quality_(jpeg_quality) {}

  using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;

  /// Frames must not come in an older order from one caller to the next than they were made, or
  /// they are compressed again.
  Bytes jpeg(const LiveFrame& frame, View view);
  /// Without loss; not kept.
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
