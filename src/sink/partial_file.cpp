#include "sink/partial_file.h"

#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "diminish/error.h"
#include "sink/png_encoder.h"

namespace diminish {

PartialFile::PartialFile(std::filesystem::path target)
    : target_(std::move(target)),
      partial_(target_.parent_path() /
               ("." + target_.stem().string() + ".partial" + target_.extension().string())) {}

PartialFile::~PartialFile() {
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(partial_, ignored);
}

void PartialFile::commit() {
  std::error_code error;
  std::filesystem::rename(partial_, target_, error);
  if (error) throw Error(Error::io, target_.string() + ": cannot be written: " + error.message());
  committed_ = true;
}

bool is_partial_file(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  return name.starts_with('.') && name.ends_with(".partial");
}

void write_file(const std::filesystem::path& target, std::string_view bytes) {
  PartialFile file(target);
  std::ofstream stream(file.path(), std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  // A full disk may show only now.
  stream.close();
  if (!stream) throw Error(Error::io, target.string() + ": cannot be written");
  file.commit();
}

void write_png(const std::filesystem::path& target, const cv::Mat& picture) {
  const std::vector<std::uint8_t> bytes = encode_png(picture);
  write_file(target, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace diminish
