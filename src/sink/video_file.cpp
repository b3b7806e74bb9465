#include "sink/video_file.h"

#include <opencv2/videoio.hpp>
#include <utility>

#include "core/mat.h"
#include "sink/partial_file.h"

namespace diminish {

struct VideoFile::Writer {
  explicit Writer(const std::filesystem::path& target) : file(target) {}
  PartialFile file;
  cv::VideoWriter video;
};

VideoFile::VideoFile(std::filesystem::path file, double frames_per_second)
    : file_(std::move(file)), frames_per_second_(frames_per_second > 0 ? frames_per_second : 30) {}
VideoFile::~VideoFile() = default;

void VideoFile::append(const Image<Bgr>& picture) {
  if (!problem_.empty()) return;
  // Encoders need even sizes, so the last column or row of an odd one is dropped.
  const cv::Rect even(0, 0, picture.width() & ~1, picture.height() & ~1);
  if (!writer_) {
    writer_ = std::make_unique<Writer>(file_);
    for (const auto codec : {cv::VideoWriter::fourcc('a', 'v', 'c', '1'),
                             cv::VideoWriter::fourcc('m', 'p', '4', 'v')}) {
      if (writer_->video.open(writer_->file.path().string(), cv::CAP_FFMPEG, codec,
                              frames_per_second_, even.size())) {
        break;
      }
    }
    if (!writer_->video.isOpened()) {
      problem_ = file_.string() + ": not written, OpenCV has no encoder for MP4 here";
      writer_.reset();
      return;
    }
  }
  writer_->video.write(as_mat(picture)(even));
}

std::string VideoFile::finish() {
  if (writer_) {
    writer_->video.release();
    writer_->file.commit();
    writer_.reset();
  }
  return problem_;
}

}  // namespace diminish
