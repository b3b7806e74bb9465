#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string_view>

namespace diminish {

/// A file that comes into being whole or not at all: written under a hidden name beside `target`
/// (with its extension), renamed by `commit`, deleted if that never comes.
class PartialFile {
 public:
  explicit PartialFile(std::filesystem::path target);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  /// Where to write.
  const std::filesystem::path& path() const { return partial_; }
  /// Throws Error that names the target if it cannot be made.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path partial_;
  bool committed_ = false;
};

/// Replaces `target` by these bytes, whole or not at all. Throws Error that names it.
void write_file(const std::filesystem::path& target, std::string_view bytes);

/// The same with an 8-bit picture as PNG, compressed for speed.
void write_png(const std::filesystem::path& target, const cv::Mat& picture);

}  // namespace diminish
