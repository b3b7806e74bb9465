#include "setup/check/host_traps.h"

#include <gmock/gmock.h>

#include "diminish/camera_source.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A machine with two cameras on one USB bus.
class HostTraps : public ::testing::Test {
 protected:
  HostTraps() {
    machine_.write("proc/sys/net/core/rmem_max", "212992\n");
    const auto devices = machine_.path() / "sys/devices/usb1";
    for (const char* camera : {"video0", "video2"}) {
      const std::string device = std::string("sys/devices/usb1/") + camera;
      machine_.write(device + "/speed", "480\n");
      machine_.write(device + "/busnum", "1\n");
      machine_.write(device + "/interface/x", "");
      const auto links = machine_.path() / "sys/class/video4linux" / camera;
      std::filesystem::create_directories(links);
      std::filesystem::create_directory_symlink(devices / camera / "interface", links / "device");
    }
    rig_.color.width = 640;
    rig_.color.height = 480;
    rig_.rgbd.push_back({.name = "rgbd0", .color = {.width = 640, .height = 480}});
  }
  std::vector<Finding> traps(const std::vector<LiveCamera>& cameras) const {
    return host_traps(rig_, cameras, machine_.path());
  }

  TemporaryFolder machine_;
  Rig rig_;
};

TEST_F(HostTraps, UdpBuffersMustHoldAnImage) {
  EXPECT_THAT(traps({{"rgbd0", "ros2:/a?color=b"}}), IsEmpty());
  const auto found = traps({{"rgbd0", "ros2:/a?color=b&interface=10.0.0.1"}});
  if (Registry<CameraSource>::is_left_out("ros2")) {  // such a camera cannot be opened
    EXPECT_THAT(found, IsEmpty());
    return;
  }
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].code, "udp-buffer");
  EXPECT_THAT(found[0].figure, HasSubstr("212992 bytes, an image 921600"));
  // These are small.
  EXPECT_THAT(traps({{"rgbd0", "ros2:/a?color=b/compressed&interface=10.0.0.1"},
                     {"rgbd0", "ros2:/a?color=compressed&interface=10.0.0.1"},
                     {"rgbd0", "ros2:/a?depth=b/compressedDepth&interface=10.0.0.1"},
                     {"rgbd0", "ros2:/a?interface=10.0.0.1"}}),
              IsEmpty());
  machine_.write("proc/sys/net/core/rmem_max", "8388608\n");
  EXPECT_THAT(traps({{"rgbd0", "ros2:/a?color=b&interface=10.0.0.1"}}), IsEmpty());
}

TEST_F(HostTraps, AUsbBusMustCarryItsCameras) {
  const std::string one = "v4l2:/dev/video0?size=640x480&fps=30";
  EXPECT_THAT(traps({{"color", one}}), IsEmpty());
  EXPECT_THAT(traps({{"color", one}, {"rgbd0", "v4l2:/dev/video2?size=640x480&fps=30"}}),
              IsEmpty());
  const auto found = traps({{"color", one}, {"rgbd0", "v4l2:/dev/video2?size=1280x720&fps=30"}});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].code, "usb-bandwidth");
  EXPECT_THAT(found[0].what, HasSubstr("color, rgbd0"));
  // 640 x 480 x 30 x 16 + 1280 x 720 x 30 x 16 bits
  EXPECT_EQ(found[0].figure, "590 of 480 Mbit/s");
  EXPECT_THAT(traps({{"color", one}, {"rgbd0", "v4l2:/dev/video2?size=1280x720&fourcc=MJPG"}}),
              IsEmpty());
}

TEST_F(HostTraps, BrowsersWantExclusiveCaps) {
  machine_.write("sys/module/v4l2loopback/parameters/exclusive_caps", "N,N,N\n");
  const auto found = traps({});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].code, "exclusive-caps");
  machine_.write("sys/module/v4l2loopback/parameters/exclusive_caps", "Y,N,N\n");
  EXPECT_THAT(traps({}), IsEmpty());
}

}  // namespace
}  // namespace diminish
