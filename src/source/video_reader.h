#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

namespace diminish {

struct VideoLength {
  int frames = 0;
  double frames_per_second = 0;
};

/// A video's properties. Throws Error that names the file if it cannot be opened or lacks them.
VideoLength measure_video(const std::filesystem::path& file);

/// Reads a video from beginning to end.
class VideoReader {
 public:
  enum class Content {
    pictures,  ///< decoded, BGR
    packets    ///< the encoded frames, one row of bytes each
  };

  /// Throws Error (without the file's name) if the file cannot be opened.
  VideoReader(const std::filesystem::path& file, Content content);

  const std::filesystem::path& file() const { return file_; }

  /// Returns a frame, skipping those before it. An earlier frame restarts the video, which is slow.
  /// The matrix is valid until the next call. Throws Error if there is no such frame.
  const cv::Mat& read(int frame);

 private:
  std::filesystem::path file_;
  Content content_;
  cv::VideoCapture capture_;
  cv::Mat current_;
  int position_ = -1;  ///< the frame in `current_`
};

}  // namespace diminish
