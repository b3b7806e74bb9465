#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "diminish/error.h"
#include "ros/bag/bag.h"

namespace diminish::ros {
namespace {

enum class Kind { none, ros1, mcap, sqlite };

Kind kind_of(const std::filesystem::path& file) {
  std::array<char, 16> first{};
  std::ifstream(file, std::ios::binary).read(first.data(), first.size());
  const std::string_view text(first.data(), first.size());
  if (text.starts_with("#ROSBAG V2.0\n")) return Kind::ros1;
  if (text.starts_with("\x89MCAP")) return Kind::mcap;
  if (text.starts_with("SQLite format 3")) return Kind::sqlite;
  return Kind::none;
}

/// The bag itself, or a folder's bags in the order of their names (ROS 2 numbers them).
std::vector<std::filesystem::path> files_of(const std::filesystem::path& bag) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(bag, ignored)) return {bag};
  std::vector<std::pair<std::size_t, std::filesystem::path>> found;
  for (const auto& entry : std::filesystem::directory_iterator(bag, ignored)) {
    if (!entry.is_regular_file(ignored) || kind_of(entry.path()) == Kind::none) continue;
    // "name_10" after "name_9".
    found.emplace_back(entry.path().string().size(), entry.path());
  }
  std::sort(found.begin(), found.end());
  std::vector<std::filesystem::path> files;
  for (auto& [length, file] : found) files.push_back(std::move(file));
  return files;
}

std::unique_ptr<BagReader> open_file(const std::filesystem::path& file) {
  const auto stream = [&] { return std::make_unique<std::ifstream>(file, std::ios::binary); };
  switch (kind_of(file)) {
    case Kind::ros1:
      return open_ros1_bag(stream());
    case Kind::mcap:
      return open_mcap(stream());
    case Kind::sqlite:
      return open_sqlite_bag(file);
    case Kind::none:
      break;
  }
  throw Error(Error::input, "expected a ROS 1 bag, a ROS 2 bag (SQLite) or an MCAP file");
}

/// One file after the other. Errors name the file.
class Files : public BagReader {
 public:
  explicit Files(std::vector<std::filesystem::path> files) : files_(std::move(files)) { open(); }

  bool next(BagMessage& message) override {
    while (true) {
      if (named([&] { return reader_->next(message); })) return true;
      if (++at_ == files_.size()) {
        --at_;
        return false;
      }
      open();
    }
  }

 private:
  void open() {
    named([&] {
      reader_ = open_file(files_[at_]);
      return true;
    });
  }
  template <class Call>
  bool named(Call call) const {
    try {
      return call();
    } catch (const Error& error) {
      throw Error(error.category(), files_[at_].string() + ": " + error.what());
    }
  }

  std::vector<std::filesystem::path> files_;
  std::size_t at_ = 0;
  std::unique_ptr<BagReader> reader_;
};

}  // namespace

std::unique_ptr<BagReader> open_bag(const std::filesystem::path& bag) {
  std::vector<std::filesystem::path> files = files_of(bag);
  if (files.empty())
    throw Error(Error::input, bag.string() + ": expected a folder with a ROS 2 bag");
  return std::make_unique<Files>(std::move(files));
}

bool is_bag(const std::filesystem::path& path) {
  const auto files = files_of(path);
  return !files.empty() && kind_of(files.front()) != Kind::none;
}

std::string ros2_type(const std::string& ros1_type) {
  const std::size_t slash = ros1_type.find('/');
  if (slash == std::string::npos || ros1_type.find('/', slash + 1) != std::string::npos) {
    return ros1_type;
  }
  return ros1_type.substr(0, slash) + "/msg" + ros1_type.substr(slash);
}

}  // namespace diminish::ros
