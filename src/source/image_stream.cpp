#include "source/image_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <system_error>

#include "core/mat.h"
#include "diminish/error.h"
#include "source/image_file.h"

namespace diminish {
namespace {

/// Videos hold depth as 16-bit PNGs; frames are decoded like such files.
template <class Pixel>
constexpr VideoReader::Content video_content = VideoReader::Content::pictures;
template <>
constexpr VideoReader::Content video_content<std::uint16_t> = VideoReader::Content::packets;

}  // namespace

template <class Pixel>
ImageStream<Pixel>::ImageStream(const std::filesystem::path& list, const Intrinsics& camera,
                                EmptyList empty)
    : folder_(list.parent_path()), camera_(camera), entries_(load_stream_list(list, empty)) {
  if (!entries_.empty()) check_first(list);
}

template <class Pixel>
void ImageStream<Pixel>::check_first(const std::filesystem::path& list) {
  const auto first = std::find_if(entries_.begin(), entries_.end(), [&](const StreamEntry& entry) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(folder_ / entry.file, ignored);
  });
  if (first == entries_.end()) {
    throw Error(Error::input,
                fmt::format("{}: none of its {} images exist, the first being {}", list.string(),
                            entries_.size(), describe(entries_.front())));
  }
  const std::string name = (folder_ / describe(*first)).string();
  cv::Mat image;
  try {
    image = decode_entry(*first);
  } catch (const Error& error) {
    // One bad file is its frame's fault. A video that fails at its start fails for all frames.
    if (!first->frame) return;
    const bool depth = video_content<Pixel> == VideoReader::Content::packets;
    throw Error(Error::input,
                name + ": " + error.what() + (depth ? ", expected a video of 16-bit PNGs" : ""));
  }
  try {
    expect_format<Pixel>(image, camera_);
  } catch (const Error& error) {
    throw Error(Error::input, name + ": " + error.what());
  }
}

template <class Pixel>
cv::Mat ImageStream<Pixel>::decode_entry(const StreamEntry& entry) {
  const std::filesystem::path file = folder_ / entry.file;
  if (!entry.frame) return decode<Pixel>(read_bytes(file));
  if (!video_ || video_->file() != file) video_.emplace(file, video_content<Pixel>);
  const cv::Mat& frame = video_->read(*entry.frame);
  if constexpr (video_content<Pixel> == VideoReader::Content::pictures) {
    return frame;
  } else {
    return decode<Pixel>({frame.datastart, frame.dataend});
  }
}

template <class Pixel>
void ImageStream<Pixel>::read(std::size_t index, Image<Pixel>& image) {
  const StreamEntry& entry = entries_[index];
  try {
    const cv::Mat decoded = decode_entry(entry);
    expect_format<Pixel>(decoded, camera_);
    copy_from(decoded, image);
  } catch (const Error& error) {
    image.resize(0, 0);
    throw Error(Error::input, describe(entry) + ": " + error.what());
  } catch (const std::bad_alloc&) {
    image.resize(0, 0);
    throw Error(Error::input, describe(entry) + ": there is not enough memory for it");
  }
}

template class ImageStream<Bgr>;
template class ImageStream<std::uint16_t>;

}  // namespace diminish
