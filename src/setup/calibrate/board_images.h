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

/// Images to search for a board, all from one camera, which need not be calibrated yet.
class BoardImages {
 public:
  virtual ~BoardImages() = default;

  /// Moves to the next image; false if there is none.
  virtual bool next() = 0;
  virtual std::string name() const = 0;
  /// Throws Error that says what is wrong with the image, without its name.
  virtual void read(Image<Bgr>& image) = 0;
};

/// Images from files, folders, or a stream of a recording.
class StoredBoardImages : public BoardImages {
 public:
  /// A folder stands for the images in it, sorted by name. Throws Error if there are none.
  explicit StoredBoardImages(const std::vector<std::filesystem::path>& files_and_folders);
  /// camera: the stream's name, such as "color" or "rgbd0_color". At most `most` images, evenly
  /// spread.
  StoredBoardImages(const std::filesystem::path& recording, const std::string& camera,
                    std::size_t most);

  bool next() override { return ++index_ < static_cast<std::ptrdiff_t>(entries_.size()); }
  std::string name() const override { return describe(current()); }
  void read(Image<Bgr>& image) override;

 private:
  const StreamEntry& current() const { return entries_[static_cast<std::size_t>(index_)]; }

  std::filesystem::path folder_;
  std::vector<StreamEntry> entries_;
  std::optional<VideoReader> video_;
  std::ptrdiff_t index_ = -1;
};

}  // namespace diminish
