#include "source/video_reader.h"

#include <cmath>
#include <system_error>
#include <vector>

#include "diminish/error.h"

namespace diminish {
namespace {

cv::VideoCapture open(const std::filesystem::path& file, VideoReader::Content content) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw Error(Error::input, "there is no such file");
  // With OpenCV before 4.7, 16-bit pixels are only possible if we decode them.
  std::vector<int> parameters;
  if (content == VideoReader::Content::packets) parameters = {cv::CAP_PROP_FORMAT, -1};
  cv::VideoCapture capture;
  try {
    capture.open(file.string(), cv::CAP_FFMPEG, parameters);
  } catch (const cv::Exception&) {
  }
  if (!capture.isOpened()) throw Error(Error::input, "cannot be opened as a video");
  // As the sensor made it, without orientation.
  capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
  return capture;
}

}  // namespace

VideoLength measure_video(const std::filesystem::path& file) {
  constexpr double max_frames = 1e7;
  try {
    const cv::VideoCapture capture = open(file, VideoReader::Content::pictures);
    const double frames = capture.get(cv::CAP_PROP_FRAME_COUNT);
    const double frames_per_second = capture.get(cv::CAP_PROP_FPS);
    if (!(frames >= 1 && frames <= max_frames))
      throw Error(Error::input, "does not say how many frames it has");
    if (!(frames_per_second > 0 && std::isfinite(frames_per_second))) {
      throw Error(Error::input, "does not say its frame rate");
    }
    return {static_cast<int>(frames), frames_per_second};
  } catch (const Error& error) {
    throw Error(Error::input, file.string() + ": " + error.what());
  }
}

VideoReader::VideoReader(const std::filesystem::path& file, Content content)
    : file_(file), content_(content), capture_(open(file, content)) {}

const cv::Mat& VideoReader::read(int frame) {
  if (frame < position_) *this = VideoReader(file_, content_);
  if (frame == position_ && !current_.empty()) return current_;
  try {
    bool more = true;
    while (more && position_ < frame) {
      more = capture_.grab();
      if (more) ++position_;
    }
    if (!more || !capture_.retrieve(current_) || current_.empty()) {
      current_.release();
      throw Error(Error::input, "cannot be decoded");
    }
  } catch (const cv::Exception&) {
    current_.release();
    throw Error(Error::input, "cannot be decoded");
  }
  return current_;
}

}  // namespace diminish
