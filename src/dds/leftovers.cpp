#include "dds/leftovers.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <ctime>
#include <string_view>
#include <system_error>
#include <vector>

namespace diminish::dds {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = "diminish_";
constexpr std::string_view shared_messages = "fast_datasharing_";
/// Fast DDS 2 and 3; the segment's name is that of its lock without the ending.
constexpr std::string_view segments[] = {"fastrtps_", "fastdds_"};
constexpr std::string_view lock_ending = "_el";

/// Opens a file that is there, of this user or writable by all, without following links.
int open_existing(const fs::path& file) {
  return open(file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
}

bool is_older(int descriptor, double age_s) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return false;
  return std::difftime(std::time(nullptr), status.st_mtime) > age_s;
}

bool is_lock_of_segment(std::string_view name) {
  if (!name.ends_with(lock_ending)) return false;
  // The ports of the transport are many programs' at once.
  for (const std::string_view segment : segments) {
    if (name.starts_with(segment) && !name.substr(segment.size()).starts_with("port")) return true;
  }
  return false;
}

/// Calls `remove` if nobody holds the lock, and holds it meanwhile.
template <class Remove>
void if_nobody_holds(const fs::path& lock, double youngest_s, const Remove& remove) {
  const int descriptor = open_existing(lock);
  if (descriptor < 0) return;
  if (is_older(descriptor, youngest_s) && flock(descriptor, LOCK_EX | LOCK_NB) == 0) remove();
  close(descriptor);
}

}  // namespace

SharedMark::SharedMark(const std::string& participant, const fs::path& folder)
    : file_(folder / (std::string(mark) + participant)) {
  constexpr mode_t own = 0600;
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, own);
  if (descriptor_ >= 0) flock(descriptor_, LOCK_EX | LOCK_NB);
}

SharedMark::~SharedMark() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  fs::remove(file_, ignored);
  close(descriptor_);
}

void remove_leftovers(const fs::path& folder, double youngest_s) {
  std::error_code error;
  std::vector<std::string> names;
  for (auto entry = fs::directory_iterator(folder, error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    names.push_back(entry->path().filename());
  }
  const auto remove = [&](const std::string& name) {
    std::error_code ignored;
    fs::remove(folder / name, ignored);
  };
  for (const std::string& name : names) {
    if (is_lock_of_segment(name)) {
      if_nobody_holds(folder / name, youngest_s, [&] {
        remove(name.substr(0, name.size() - lock_ending.size()));
        remove(name);
      });
    } else if (name.starts_with(mark)) {
      const std::string shared = std::string(shared_messages) + name.substr(mark.size()) + "_";
      if_nobody_holds(folder / name, youngest_s, [&] {
        for (const std::string& other : names) {
          if (other.starts_with(shared)) remove(other);
        }
        remove(name);
      });
    }
  }
}

}  // namespace diminish::dds
