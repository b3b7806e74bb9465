#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace diminish {

/// A folder, in memory where the machine has such, whose files an input says: "== NAME" on a line
/// begins one, what follows is in it.
class FuzzedFolder {
 public:
  FuzzedFolder() {
    std::error_code ignored;
    std::filesystem::path above = "/dev/shm";
    if (!std::filesystem::is_directory(above, ignored)) {
      above = std::filesystem::temp_directory_path();
    }
    std::string pattern = (above / "diminish_fuzz_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~FuzzedFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  FuzzedFolder(const FuzzedFolder&) = delete;
  FuzzedFolder& operator=(const FuzzedFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Replaces all files.
  void fill(std::string_view input) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(path_, ignored)) {
      std::filesystem::remove_all(entry.path(), ignored);
    }
    constexpr int most_files = 64;
    std::size_t begin = input.starts_with(mark.substr(1)) ? 0 : next_mark(input, 0);
    for (int i = 0; i < most_files && begin < input.size(); ++i) {
      const std::size_t end = next_mark(input, begin);
      const std::string_view section = input.substr(begin, end - begin);
      const std::size_t line_end = std::min(section.find('\n'), section.size());
      const std::string_view name = section.substr(mark.size() - 1, line_end - (mark.size() - 1));
      if (line_end < section.size()) write(name, section.substr(line_end + 1));
      begin = end;
    }
  }
  void fill(const std::uint8_t* data, std::size_t size) {
    fill({reinterpret_cast<const char*>(data), size});
  }

 private:
  static constexpr std::string_view mark = "\n== ";

  /// Where the section after that at `begin` begins, without its mark's line feed.
  static std::size_t next_mark(std::string_view input, std::size_t begin) {
    const std::size_t found = input.find(mark, begin);
    return found == std::string_view::npos ? input.size() : found + 1;
  }

  void write(std::string_view name, std::string_view content) const {
    constexpr std::size_t longest = 100;
    const bool leaves_folder = name.find("..") != std::string_view::npos || name.starts_with('/');
    if (name.empty() || name.size() > longest || leaves_folder ||
        name.find('\0') != std::string_view::npos) {
      return;
    }
    const std::filesystem::path file = path_ / name;
    std::error_code ignored;
    std::filesystem::create_directories(file.parent_path(), ignored);
    if (std::filesystem::is_directory(file, ignored)) return;
    std::ofstream(file, std::ios::binary)
        .write(content.data(), static_cast<std::streamsize>(content.size()));
  }

  std::filesystem::path path_;
};

}  // namespace diminish
