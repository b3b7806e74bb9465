#include "live/frame_forwarder.h"

#include <gtest/gtest.h>

#include <chrono>

#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "paths.h"

namespace diminish {
namespace {

std::string eventual_problem(const FrameForwarder& forwarder) {
  for (int i = 0; i < 3000 && forwarder.problem().empty(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return forwarder.problem();
}

// A thread that throws would end the program.
TEST(FrameForwarder, SaysWhyItNoLongerWritesAndTheSessionGoesOn) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar");
  const std::string replay = "recording:" + recording.folder.string() + "?loop";
  LiveSession session(recording.rig, recording.scene, {}, {{"color", replay}, {"rgbd0", replay}},
                      {});
  std::atomic<int> written = 0;
  const FrameForwarder forwarder(session, [&](const LiveFrame& frame) {
    EXPECT_EQ(frame.result.picture.width(), recording.rig.color.width);
    if (++written == 2) throw Error("the device is gone");
  });
  const FrameForwarder other(session, [](const LiveFrame&) { throw 7; });
  EXPECT_EQ(eventual_problem(forwarder), "the device is gone");
  EXPECT_EQ(eventual_problem(other), "an unknown error");
  const std::size_t shown = session.status().frames;
  EXPECT_TRUE(session.wait_for_frame(shown, std::chrono::seconds(30)));
  EXPECT_EQ(written, 2);
}

}  // namespace
}  // namespace diminish
