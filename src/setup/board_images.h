#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "diminish/image.h"
#include "source/stream_list.h"
#include "source/video_reader.h"

namespace diminish {

/// Images of one camera, from files, folders, or a stream of a recording, which need not be
/// calibrated yet. All must have the first one's size.
class BoardImages {
 public:
  /// Folders stand for the images in them, by name. Throws Error if there are none.
  explicit BoardImages(const std::vector<std::filesystem::path>& files_and_folders);
  /// camera: the stream's name: "color", "rgbd0_color". At most `most` images, evenly spread.
  BoardImages(const std::filesystem::path& recording, const std::string& camera, std::size_t most);

  std::size_t size() const { return entries_.size(); }
  std::string name(std::size_t index) const;
  /// Throws Error that says what is wrong with the image, without its name.
  void read(std::size_t index, Image<Bgr>& image);

  int width() const { return width_; }  ///< 0 before the first image was read
  int height() const { return height_; }

 private:
  std::filesystem::path folder_;
  std::vector<StreamEntry> entries_;
  std::optional<VideoReader> video_;
  int width_ = 0, height_ = 0;
};

}  // namespace diminish
