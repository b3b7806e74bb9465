#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string_view>

namespace diminish {

/// A file that appears complete or not at all: written under a hidden name beside `target` (with
/// its extension), renamed by `commit`, deleted otherwise.
class PartialFile {
 public:
  explicit PartialFile(std::filesystem::path target);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  /// The file to write to.
  const std::filesystem::path& path() const { return partial_; }
  /// Throws Error that names the target if it cannot be created.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path partial_;
  bool committed_ = false;
};

/// Whether a file has the name of one that was begun and never finished: the program was killed.
bool is_partial_file(const std::filesystem::path& file);

/// Replaces `target` by these bytes, completely or not at all. Throws Error that names it.
void write_file(const std::filesystem::path& target, std::string_view bytes);

/// The same for an 8-bit picture as PNG (encode_png).
void write_png(const std::filesystem::path& target, const cv::Mat& picture);

}  // namespace diminish
