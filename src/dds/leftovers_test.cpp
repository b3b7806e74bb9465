#include "dds/leftovers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "temporary_folder.h"

namespace diminish::dds {
namespace {

namespace fs = std::filesystem;
using ::testing::UnorderedElementsAre;

class Leftovers : public ::testing::Test {
 protected:
  fs::path add(const std::string& name) {
    std::ofstream(folder_ / name) << 'x';
    return folder_ / name;
  }
  /// As if made a minute ago.
  void make_old() {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      fs::last_write_time(entry, fs::file_time_type::clock::now() - std::chrono::minutes(1));
    }
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename());
    }
    return names;
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(Leftovers, OfKilledProgramsAreRemovedAndOthersLeft) {
  const std::string killed = "01.0f.78.fd.0c.5c.db.61.00.00.00.00";
  const std::string alive = "01.0f.78.fd.0d.5c.db.61.00.00.00.00";
  add("fastrtps_0123456789abcdef");
  add("fastrtps_0123456789abcdef_el");
  add("fastrtps_fedcba9876543210");
  const int held = open((add("fastrtps_fedcba9876543210_el")).c_str(), O_RDWR);
  ASSERT_EQ(flock(held, LOCK_EX), 0);
  add("fastrtps_port7411");
  add("fastrtps_port7411_el");
  add("diminish_" + killed);
  add("fast_datasharing_" + killed + "_0.0.1.3");
  add("fast_datasharing_" + killed + "_0.0.2.3");
  const SharedMark mark(alive, folder_);
  add("fast_datasharing_" + alive + "_0.0.1.3");
  add("fast_datasharing_01.0f.78.fd.0e.5c.db.61.00.00.00.00_0.0.1.3");  // not diminish
  add("somebody's");
  make_old();
  remove_leftovers(folder_);
  EXPECT_THAT(names(),
              UnorderedElementsAre("fastrtps_fedcba9876543210", "fastrtps_fedcba9876543210_el",
                                   "fastrtps_port7411", "fastrtps_port7411_el", "diminish_" + alive,
                                   "fast_datasharing_" + alive + "_0.0.1.3",
                                   "fast_datasharing_01.0f.78.fd.0e.5c.db.61.00.00.00.00_0.0.1.3",
                                   "somebody's"));
  close(held);
}

TEST_F(Leftovers, WhatIsYoungIsLeft) {
  add("fastrtps_0123456789abcdef");
  add("fastrtps_0123456789abcdef_el");
  remove_leftovers(folder_);
  EXPECT_EQ(names().size(), 2U);
}

TEST_F(Leftovers, AMarkEndsWithItsParticipant) {
  { const SharedMark mark("a", folder_); }
  EXPECT_TRUE(names().empty());
}

TEST_F(Leftovers, LinksAndMissingFoldersAreLeft) {
  const fs::path kept = add("kept");
  fs::create_symlink(kept, folder_ / "fastrtps_0123456789abcdef_el");
  make_old();
  remove_leftovers(folder_);
  EXPECT_EQ(names().size(), 2U);
  EXPECT_NO_THROW(remove_leftovers(folder_ / "none"));
}

}  // namespace
}  // namespace diminish::dds
