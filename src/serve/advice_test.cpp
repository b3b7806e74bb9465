#include "serve/advice.h"

#include <gmock/gmock.h>

#include <set>

#include "diminish/live.h"
#include "live/session_status.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

// What the session itself says of its cameras.
TEST(Advice, SaysWhatToDoAboutEveryProblemOfACamera) {
  LiveStatus status;
  for (const CameraState state : {CameraState::lost, CameraState::silent}) {
    CameraStatus camera;
    camera.name = "rgbd0";
    camera.state = state;
    camera.problem = "no image for 1 s";
    status.cameras.push_back(camera);
  }
  describe_problems_of_cameras(status);
  ASSERT_EQ(status.problems.size(), 2U);
  std::set<std::string> different;
  for (const std::string& problem : status.problems) {
    EXPECT_THAT(advice_for(problem), HasSubstr("cable")) << problem;
    different.insert(advice_for(problem));
  }
  EXPECT_EQ(different.size(), 2U);
}

TEST(Advice, TellsAMarkerOfTheWorldFromAnObjects) {
  EXPECT_THAT(advice_for("world marker 49 not visible in color"), HasSubstr("turn the camera"));
  EXPECT_THAT(advice_for("calendar: marker 3 not visible in any camera"),
              HasSubstr("show the object's marker"));
}

TEST(Advice, SaysNothingWhereNothingIsKnownOrTheProblemSaysIt) {
  EXPECT_EQ(advice_for("rgbd0: what it sees does not fit the picture. Has it moved? diminish "
                       "calibrate rig --repair. Is it late, or its calibration another's? diminish "
                       "check"),
            "");
  EXPECT_EQ(advice_for("mask_margin_px: expected 0 to 1000"), "");
}

}  // namespace
}  // namespace diminish
