#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "diminish/camera_source.h"
#include "expect_error.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using Status = CameraSource::Status;

std::unique_ptr<CameraSource> open(const std::string& pipeline) {
  return open_camera("gst:" + pipeline, {"color", nullptr, 0});
}

/// The next image; fails the test if none comes.
CameraImage next_image(CameraSource& camera) {
  CameraImage image;
  for (int i = 0; i < 300; ++i) {
    if (camera.read(image, milliseconds(100)) == Status::image) return image;
  }
  ADD_FAILURE() << "no image";
  return image;
}

TEST(GstreamerCamera, DeliversColour) {
  const auto camera = open(
      "videotestsrc is-live=true pattern=red ! "
      "video/x-raw,format=BGR,width=70,height=34,framerate=50/1");
  double last_s = 0;
  for (int i = 0; i < 5; ++i) {
    const CameraImage image = next_image(*camera);
    ASSERT_EQ(image.sensor, Sensor::color);
    ASSERT_EQ(image.color.width(), 70);
    ASSERT_EQ(image.color.height(), 34);
    EXPECT_EQ(image.color(69, 33), (Bgr{0, 0, 255}));
    EXPECT_GT(image.stamp_s, last_s);
    EXPECT_LE(image.stamp_s, monotonic_now_s());
    last_s = image.stamp_s;
  }
}

TEST(GstreamerCamera, Delivers16BitDepth) {
  // Two rows of four pixels, as a file of raw little-endian numbers.
  const TemporaryFolder folder;
  const std::vector<std::uint16_t> depths = {1, 2, 300, 4000, 50000, 65535, 0, 256};
  std::ofstream file(folder.path() / "depth.raw", std::ios::binary);
  file.write(reinterpret_cast<const char*>(depths.data()), 16);
  file.close();
  const auto camera =
      open("filesrc blocksize=16 location=" + (folder.path() / "depth.raw").string() +
           " ! video/x-raw,format=GRAY16_LE,width=4,height=2,framerate=30/1");
  const CameraImage image = next_image(*camera);
  ASSERT_EQ(image.sensor, Sensor::depth);
  ASSERT_EQ(image.depth.width(), 4);
  EXPECT_EQ(std::vector<std::uint16_t>(image.depth.begin(), image.depth.end()), depths);
}

TEST(GstreamerCamera, EndsWithThePipeline) {
  const auto camera = open("videotestsrc num-buffers=2 ! video/x-raw,format=BGR,width=8,height=8");
  Status status = Status::nothing;
  for (int i = 0; i < 300 && status != Status::end; ++i) {
    CameraImage image;
    status = camera->read(image, milliseconds(100));
  }
  EXPECT_EQ(status, Status::end);
}

TEST(GstreamerCamera, APipelineThatCannotBeIsAnError) {
  EXPECT_THAT(error_of([] { open("nosuchelement"); }), HasSubstr("nosuchelement"));
  EXPECT_THAT(error_of([] {
                const auto camera = open("filesrc location=/nowhere ! decodebin ! videoconvert");
                for (CameraImage image; camera->read(image, milliseconds(200)) != Status::end;) {
                }
              }),
              HasSubstr("/nowhere"));
}

TEST(GstreamerCamera, TakesImagesOfAnotherProcess) {
  // As docs/live.md shows for cameras whose SDK is not here.
  const TemporaryFolder folder;
  const std::string socket = (folder.path() / "camera").string();
  const pid_t server = fork();
  if (server == 0) {
    execlp("gst-launch-1.0", "gst-launch-1.0", "-q", "videotestsrc", "is-live=true",
           "pattern=green", "!", "video/x-raw,format=BGR,width=64,height=48,framerate=50/1", "!",
           "shmsink", ("socket-path=" + socket).c_str(), "wait-for-connection=false",
           "shm-size=1000000", nullptr);
    _exit(127);
  }
  for (int i = 0; i < 1000 && !std::filesystem::exists(socket); ++i) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  {
    const auto camera = open("shmsrc is-live=true do-timestamp=true socket-path=" + socket +
                             " ! video/x-raw,format=BGR,width=64,height=48,framerate=50/1");
    EXPECT_EQ(next_image(*camera).color(5, 5), (Bgr{0, 255, 0}));
    kill(server, SIGTERM);
    EXPECT_NE(error_of([&] {
                CameraImage image;
                for (int i = 0; i < 300; ++i) {
                  if (camera->read(image, milliseconds(100)) == Status::end) {
                    throw Error("the other process ended");
                  }
                }
              }),
              "");
  }
  waitpid(server, nullptr, 0);
}

}  // namespace
}  // namespace diminish
