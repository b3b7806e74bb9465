#include "sink/partial_file.h"

#include <fstream>
#include <system_error>
#include <utility>

#include "diminish/error.h"

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
  if (error) throw Error(target_.string() + ": cannot be written: " + error.message());
  committed_ = true;
}

void write_text_file(const std::filesystem::path& target, const std::string& text) {
  PartialFile file(target);
  std::ofstream stream(file.path(), std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw Error(target.string() + ": cannot be written");
  file.commit();
}

}  // namespace diminish
