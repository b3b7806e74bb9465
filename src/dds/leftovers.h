#pragma once

#include <filesystem>
#include <string>

namespace diminish::dds {

/// Where programs of one machine hand messages over.
inline constexpr const char* shared_memory_folder = "/dev/shm";

/// A file that says that a participant is there. It is locked, and a lock ends with its program,
/// however that ends. Without such a file what the participant shares is nobody's for sure.
class SharedMark {
 public:
  /// participant: its GUID's prefix as Fast DDS writes it into the names of its files. Where no
  /// file can be made there is no mark.
  explicit SharedMark(const std::string& participant,
                      const std::filesystem::path& folder = shared_memory_folder);
  ~SharedMark();
  SharedMark(const SharedMark&) = delete;
  SharedMark& operator=(const SharedMark&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// Removes what killed programs have left: the segments of Fast DDS's shared-memory transport whose
/// own lock nobody holds, and messages shared by participants whose mark nobody holds. What is
/// younger than `youngest_s` is left: it may be about to be locked. So is what cannot be removed.
void remove_leftovers(const std::filesystem::path& folder = shared_memory_folder,
                      double youngest_s = 10);

}  // namespace diminish::dds
