#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "diminish/error.h"
#include "source/image_stream.h"
#include "source/tiny_recording.h"

namespace diminish {
namespace {

/// Of this process: what it has, and `bytes` more.
void limit_memory(std::size_t bytes) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limit = {most, most};
  if (setrlimit(RLIMIT_AS, &limit) != 0) std::abort();
}

/// Reads the second image; then it goes on with the third. Ends the process: 0 if that worked.
[[noreturn]] void read_with_little_memory(const TinyRecording& recording) {
  const Intrinsics camera = load_rig(recording.path("rig.yaml")).color;
  ImageStream<Bgr> stream(recording.path("color.txt"), camera, EmptyList::is_error);
  Image<Bgr> image;
  limit_memory(64 << 20);
  try {
    stream.read(1, image);
  } catch (const Error& error) {
    std::fputs(error.what(), stderr);
  }
  stream.read(2, image);
  std::exit(image.width() == camera.width ? 0 : 1);
}

TEST(ImageMemory, AnImageThatDoesNotFitIntoMemoryIsAFaultOfItsFrame) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more than any limit";
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
  GTEST_SKIP() << "sanitizers need more than any limit";
#endif
#endif
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const char* format : {"jpg", "png", "bmp"}) {
    const TinyRecording recording;
    const std::string large = fmt::format("color/large.{}", format);
    recording.write(large, cv::Mat(6000, 9000, CV_8UC1, cv::Scalar(90)));
    recording.write("color.txt", "1 color/0.png\n2 " + large + "\n3 color/2.png\n");
    EXPECT_EXIT(read_with_little_memory(recording), ::testing::ExitedWithCode(0),
                "large.* there is not enough memory for it")
        << format;
  }
}

}  // namespace
}  // namespace diminish
