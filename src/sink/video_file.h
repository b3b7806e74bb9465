#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "diminish/image.h"

namespace diminish {

/// An MP4 of pictures of one size. It gets its name only when it is complete.
class VideoFile {
 public:
  VideoFile(std::filesystem::path file, double frames_per_second);
  ~VideoFile();

  void append(const Image<Bgr>& picture);
  /// Ends the video. Returns why there is none, or an empty text if all is well.
  std::string finish();

 private:
  class Writer;
  /// Any problem ends the video.
  template <class Action>
  void attempt(const Action& action);

  std::filesystem::path file_;
  double frames_per_second_;
  std::unique_ptr<Writer> writer_;
  std::string problem_;
};

}  // namespace diminish
