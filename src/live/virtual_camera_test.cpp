#include "diminish/virtual_camera.h"

#include <gmock/gmock.h>

#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "diminish/frame_source.h"
#include "paths.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

const std::filesystem::path folder = std::filesystem::path(testing::recordings_dir()) / "calendar";

TEST(VirtualCamera, HandsOverTheResultsPixels) {
  const Recording recording = load_recording(folder);
  const std::string replay = "recording:" + folder.string() + "?loop";
  LiveSession session(recording.rig, recording.scene, {}, {{"color", replay}, {"rgbd0", replay}},
                      {});
  std::vector<Image<Bgr>> shown;
  const auto listener =
      session.on_frame([&](const auto& frame) { shown.push_back(frame->result.picture); });
  const TemporaryFolder out;
  const auto file = out.path() / "video.raw";
  const std::size_t frame_bytes =
      3 * recording.rig.color.bounds().width * static_cast<std::size_t>(recording.rig.color.height);
  {
    const VirtualCamera camera(
        session, "gst:video/x-raw,format=BGR ! filesink location=" + file.string(), 30);
    std::error_code ignored;
    for (int i = 0; i < 3000 && !(std::filesystem::exists(file) &&
                                  std::filesystem::file_size(file, ignored) >= 3 * frame_bytes);
         ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  session.stop();
  std::ostringstream bytes;
  bytes << std::ifstream(file, std::ios::binary).rdbuf();
  const std::string video = bytes.str();
  ASSERT_GE(video.size(), 3 * frame_bytes);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::any_of(shown.begin(), shown.end(), [&](const Image<Bgr>& picture) {
      return std::memcmp(picture.data(), video.data() + i * frame_bytes, frame_bytes) == 0;
    })) << i;
  }
}

}  // namespace
}  // namespace diminish
