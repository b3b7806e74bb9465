#include "sink/recording_folder.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <iterator>

#include "expect_error.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// This process's files cannot grow beyond some bytes: what is too much of a write is left out, as
/// on a full disk.
class FullDisk {
 public:
  explicit FullDisk(std::uintmax_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limited = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

FrameSet frame_at(double stamp_s) {
  FrameSet frame;
  frame.stamp_s = stamp_s;
  frame.color.own().resize(8, 8, Bgr{1, 2, 3});
  return frame;
}

TEST(RecordingFolder, AFullDiskLeavesWholeLines) {
  for (const std::uintmax_t room : {0, 1, 12, 30}) {
    SCOPED_TRACE(room);
    const TemporaryFolder temporary;
    const auto scene_file = temporary.write("scene.yaml", "occluders: []\n");
    RecordingFolder folder(temporary.path() / "out", Rig{}, scene_file, Scene{},
                           RecordingFolder::Pictures::png);
    // Until the list is longer than an image.
    for (int i = 0; i < 20; ++i)
      folder.write(frame_at(i), "a_picture_with_a_long_name" + std::to_string(i));
    const auto list = temporary.path() / "out" / "color.txt";
    const std::string before = text_of(list);
    {
      const FullDisk full(before.size() + room);
      EXPECT_THAT(error_of([&] { folder.write(frame_at(100), "the_one_that_is_too_much"); }),
                  HasSubstr("color.txt: cannot be written"));
    }
    EXPECT_EQ(text_of(list), before);
  }
}

}  // namespace
}  // namespace diminish
