#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "source/stream_list.h"
#include "source/video_reader.h"

namespace diminish {

/// The images of one sensor, in the order of a list: colour (`Bgr`) or depth (`std::uint16_t`).
template <class Pixel>
class ImageStream {
 public:
  /// list: the "timestamp filename" file; names in it are relative to its folder. Throws Error if
  /// the list is unusable, none of its files exist, or the first that exists has another size or
  /// type: then every frame would be wrong.
  ImageStream(const std::filesystem::path& list, const Intrinsics& camera,
              EmptyList empty = EmptyList::is_error);

  const std::vector<StreamEntry>& entries() const { return entries_; }

  /// Whether an image is one of a video's. Those are read one after another, fast if `index` never
  /// goes down between calls. All others may be read by several threads at the same time.
  bool needs_order(std::size_t index) const { return entries_[index].frame.has_value(); }

  /// Throws Error with the file's name as in the list and what was expected. `image` is empty then.
  void read(std::size_t index, Image<Pixel>& image);

 private:
  cv::Mat decode_entry(const StreamEntry& entry);
  void check_first(const std::filesystem::path& list);

  std::filesystem::path folder_;
  Intrinsics camera_;
  std::vector<StreamEntry> entries_;
  std::optional<VideoReader> video_;
};

}  // namespace diminish
