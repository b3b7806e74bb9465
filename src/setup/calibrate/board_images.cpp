#include "setup/calibrate/board_images.h"

#include <algorithm>
#include <system_error>

#include "core/mat.h"
#include "diminish/error.h"
#include "source/image_file.h"

namespace diminish {
namespace {

bool is_image(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr const char* known[] = {".png",  ".jpg",  ".jpeg", ".bmp", ".tif",
                                   ".tiff", ".webp", ".pgm",  ".ppm"};
  return std::find(std::begin(known), std::end(known), extension) != std::end(known);
}

}  // namespace

StoredBoardImages::StoredBoardImages(const std::vector<std::filesystem::path>& files_and_folders) {
  for (const std::filesystem::path& path : files_and_folders) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(path, ignored)) {
      entries_.push_back({0, path, std::nullopt, 0});
      continue;
    }
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(path, ignored)) {
      if (is_image(entry.path())) files.push_back(entry.path());
    }
    if (files.empty())
      throw Error(Error::input, path.string() + ": expected images in this folder");
    std::sort(files.begin(), files.end());
    for (const auto& file : files) entries_.push_back({0, file, std::nullopt, 0});
  }
  if (entries_.empty()) throw Error(Error::input, "expected images of the board, or --recording");
}

StoredBoardImages::StoredBoardImages(const std::filesystem::path& recording,
                                     const std::string& camera, std::size_t most)
    : folder_(recording) {
  const std::vector<StreamEntry> all = load_stream_list(recording / (camera + ".txt"));
  const std::size_t count = std::min(most, all.size());
  for (std::size_t i = 0; i < count; ++i) entries_.push_back(all[i * all.size() / count]);
}

void StoredBoardImages::read(Image<Bgr>& image) {
  const StreamEntry& entry = current();
  const std::filesystem::path file = folder_ / entry.file;
  if (entry.frame) {
    if (!video_ || video_->file() != file) video_.emplace(file, VideoReader::Content::pictures);
    copy_from(video_->read(*entry.frame), image);
  } else {
    copy_from(decode<Bgr>(read_bytes(file)), image);
  }
}

}  // namespace diminish
