// Keys that `diminish keys` made, with Cyclone DDS's own DDS Security.

#include <gmock/gmock.h>

#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "background_program.h"
#include "cyclone_environment.h"
#include "dds/dds.h"
#include "diminish/camera_source.h"
#include "paths.h"
#include "ros/messages.h"
#include "ros2_domain.h"
#include "setup/keys/keys.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

/// A plugin of Cyclone DDS: its element's name, its library's and its functions' ends.
std::string plugin(const std::string& element, const std::string& library, const std::string& name,
                   const std::string& files) {
  return "<" + element + "><Library path='" CYCLONE_PLUGINS "/libdds_security_" + library +
         ".so' initFunction='init_" + name + "' finalizeFunction='finalize_" + name + "'/>" +
         files + "</" + element + ">";
}
std::string file(const std::string& element, const std::string& path) {
  return "<" + element + ">file:" + path + "</" + element + ">";
}

/// Cyclone DDS has the keys of "user", diminish those of "camera": of two participants, that one
/// begins whose name's hash is less, and Fast DDS 2.9 as the first writes its half of the secret as
/// Cyclone DDS 0.10 does not read it (eProsima/Fast-DDS issue 3802).
class Ros2KeysCyclone : public ::testing::Test {
 protected:
  Ros2KeysCyclone() {
    const auto made = make_keys(store_.path() / "store", {.names = {"camera", "user"}}).folders;
    own_ = made[0].string();
    const std::string its = made[1].string();
    environment_.emplace("<Security>" +
                         plugin("Authentication", "auth", "authentication",
                                file("IdentityCA", its + "/identity_ca.cert.pem") +
                                    file("IdentityCertificate", its + "/cert.pem") +
                                    file("PrivateKey", its + "/key.pem")) +
                         plugin("AccessControl", "ac", "access_control",
                                file("Governance", its + "/governance.p7s") +
                                    file("PermissionsCA", its + "/permissions_ca.cert.pem") +
                                    file("Permissions", its + "/permissions.p7s")) +
                         plugin("Cryptographic", "crypto", "crypto", "") + "</Security>");
  }

  TemporaryFolder store_;
  Ros2Domain domain_;
  std::optional<CycloneEnvironment> environment_;
  std::string own_;
};

TEST_F(Ros2KeysCyclone, ItsCameraIsReadWithKeys) {
  const BackgroundProgram sender({domain_.text(), "/camera"}, beside_the_program("cyclone_sender"));
  const auto camera =
      open_camera("ros2:/camera?depth=depth/image_raw&keys=" + own_, {"rgbd0", nullptr, 0});
  const auto keyless = open_camera("ros2:/camera?depth=depth/image_raw", {"rgbd0", nullptr, 0});
  CameraImage image;
  int images = 0;
  for (const double end_s = monotonic_now_s() + 60; images < 20 && monotonic_now_s() < end_s;) {
    if (camera->read(image, milliseconds(100)) != CameraSource::Status::image) continue;
    ++images;
    ASSERT_EQ(image.depth.size(), 64U * 48);
    EXPECT_EQ(image.depth.data()[77], 577);
    EXPECT_EQ(keyless->read(image, milliseconds(1)), CameraSource::Status::nothing);
  }
  EXPECT_EQ(images, 20);
}

TEST_F(Ros2KeysCyclone, ItReadsWhatIsSentWithKeys) {
  Program receiver({domain_.text(), "image", "/a/image"}, beside_the_program("cyclone_receiver"));
  const auto node = dds::Node::open({.domain = domain_.number(), .keys = own_});
  dds::Publication publication(node, {"/a/image", ros::ImageMessage::dds_type},
                               dds::Delivery::newest);
  const std::vector<std::uint8_t> pixels(std::size_t{64} * 48 * 3, 7);
  ros::ImageMessage message;
  message.header.frame_id = "frame";
  message.width = 64;
  message.height = 48;
  message.step = 64 * 3;
  message.encoding = "bgr8";
  message.data = pixels;
  std::vector<std::uint8_t> bytes;
  ros::write_message(message, bytes);
  std::atomic<bool> is_over = false;
  std::thread sender([&] {
    while (!is_over) {
      publication.send(bytes);
      std::this_thread::sleep_for(milliseconds(30));
    }
  });
  const auto outcome = receiver.wait();
  is_over = true;
  sender.join();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("frame 64x48 bgr8 step 192 bytes 9216 sum 64512"));
}

}  // namespace
}  // namespace diminish
