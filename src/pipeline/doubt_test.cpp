#include "pipeline/doubt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "diminish/runner.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

using testing::recordings;

/// The bundled recordings, and what may be wrong with them.
class Doubtful : public ::testing::TestWithParam<const char*> {
 protected:
  void load(const std::string& name) { recording = load_recording(recordings / name); }
  /// The colour sensor no longer stands beside its depth sensor as it was calibrated.
  void bump() {
    RgbdCamera& camera = recording.rig.rgbd[0];
    camera.color_from_depth.rotation *=
        Eigen::AngleAxisd(2 * std::numbers::pi / 180, Eigen::Vector3d::UnitY()).toRotationMatrix();
  }
  void process(const Options& options, std::size_t most_frames = 100) {
    const auto source = open_recording(recording, options);
    Pipeline pipeline(recording.rig, recording.scene, options);
    DiminishedFrame result;
    FrameSet frame;
    while (results.size() < most_frames && source->next(frame)) {
      pipeline.process(frame, result);
      results.push_back(result);
      pictures.push_back(frame.color.own());
    }
  }

  Recording recording;
  std::vector<DiminishedFrame> results;
  std::vector<Image<Bgr>> pictures;
};

INSTANTIATE_TEST_SUITE_P(Recordings, Doubtful,
                         ::testing::Values("calendar", "ball", "workbench", "stereo", "arm"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST_P(Doubtful, GoodSetUpsAreNot) {
  load(GetParam());
  process({});
  for (const DiminishedFrame& result : results) {
    for (const auto& fit : result.report.fit) {
      ASSERT_TRUE(fit);
      EXPECT_GT(*fit, 0.83) << result.name;
    }
    EXPECT_FALSE(result.report.in_doubt);
  }
}

class DoubtfulDepth : public Doubtful {};
INSTANTIATE_TEST_SUITE_P(Recordings, DoubtfulDepth,
                         ::testing::Values("calendar", "ball", "workbench", "arm"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST_P(DoubtfulDepth, OfABumpedCamera) {
  load(GetParam());
  bump();
  process({});
  for (const DiminishedFrame& result : results) {
    EXPECT_TRUE(result.report.in_doubt) << result.name;
    EXPECT_THAT(result.report.messages, Contains(HasSubstr(recording.rig.rgbd[0].name)));
    // Marked, but shown
    EXPECT_GT(result.report.valid_pixels, 0U);
  }
}

TEST_P(DoubtfulDepth, InAWrongUnit) {
  load(GetParam());
  for (RgbdCamera& camera : recording.rig.rgbd) camera.depth_unit_m *= 1.25;
  process({});
  for (const DiminishedFrame& result : results) EXPECT_TRUE(result.report.in_doubt);
}

class DoubtfulMarkers : public Doubtful {};
INSTANTIATE_TEST_SUITE_P(Recordings, DoubtfulMarkers,
                         ::testing::Values("calendar", "ball", "workbench"),
                         [](const auto& tested) { return std::string(tested.param); });

// Nothing is in view then that could be compared with the picture.
TEST_P(DoubtfulMarkers, TellADepthUnitOfAFifth) {
  load(GetParam());
  for (RgbdCamera& camera : recording.rig.rgbd) camera.depth_unit_m /= 5;
  process({});
  for (const DiminishedFrame& result : results) {
    EXPECT_TRUE(result.report.in_doubt);
    EXPECT_THAT(result.report.messages, Contains(HasSubstr("depth_unit_m")));
  }
}

class DoubtfulLens : public Doubtful {};
INSTANTIATE_TEST_SUITE_P(Recordings, DoubtfulLens,
                         ::testing::Values("calendar 1.12", "ball 0.88", "workbench 0.95"),
                         [](const auto& tested) {
                           const std::string name = tested.param;
                           return name.substr(0, name.find(' '));
                         });

// Poses that are found with it make it good for what is near the world marker. The ball has no
// marker by which it could be told.
TEST_P(DoubtfulLens, IsToldWithinThreeFrames) {
  const std::string name = GetParam();
  const std::size_t space = name.find(' ');
  load(name.substr(0, space));
  const double wrong = std::stod(name.substr(space));
  recording.rig.color.fx *= wrong;
  recording.rig.color.fy *= wrong;
  process({}, 3);
  std::vector<std::string> messages;
  for (const DiminishedFrame& result : results) {
    messages.insert(messages.end(), result.report.messages.begin(), result.report.messages.end());
  }
  EXPECT_TRUE(std::any_of(results.begin(), results.end(),
                          [](const auto& result) { return result.report.in_doubt; }));
  EXPECT_THAT(messages, Contains(HasSubstr(wrong > 1 ? "5 % smaller" : "5 % larger")));
  EXPECT_THAT(messages, Contains(HasSubstr("calibrate intrinsics")));
}

/// A scan as the only background.
class DoubtfulScan : public ::testing::Test {
 protected:
  static std::vector<DiminishedFrame> show(const std::string& of, const std::string& in) {
    Options options;
    Recording recording = load_recording(recordings / in);
    Recording scanned = load_recording(recordings / of);
    scanned.scene.world_marker = recording.scene.world_marker;
    scanned.rig.color = recording.rig.color;
    const Scan scan = scan_recording(scanned, options, {});
    const auto source = open_recording(recording, options);
    recording.rig.rgbd.clear();
    Pipeline pipeline(recording.rig, recording.scene, options);
    pipeline.set_background(scan);
    std::vector<DiminishedFrame> results;
    for (FrameSet frame; source->next(frame);) {
      frame.rgbd.clear();
      pipeline.process(frame, results.emplace_back());
    }
    return results;
  }
};

TEST_F(DoubtfulScan, OfThisRoomIsNot) {
  for (const DiminishedFrame& result : show("calendar", "calendar")) {
    EXPECT_GT(result.report.memory.background_pixels, 0U);
    EXPECT_FALSE(result.report.in_doubt);
  }
}

// The same desk, with other posters behind it
TEST_F(DoubtfulScan, OfAnotherRoom) {
  std::size_t shown = 0;
  for (const DiminishedFrame& result : show("calendar", "ball")) {
    if (result.report.memory.background_pixels == 0) continue;
    ++shown;
    EXPECT_TRUE(result.report.in_doubt) << result.name;
    EXPECT_THAT(result.report.messages, Contains(HasSubstr("diminish scan")));
  }
  EXPECT_GT(shown, 0U);
}

class OnDoubt : public Doubtful {};

TEST_F(OnDoubt, TheCamerasPictureMayBeShown) {
  load("ball");
  bump();
  Options options;
  options.on_doubt = "pass-through";
  options.remove_shadows = true;
  process(options);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].picture, pictures[i]);
    EXPECT_EQ(count_equal(results[i].provenance, provenance::camera, results[i].mask.bounds()),
              results[i].mask.size());
  }
}

TEST_F(OnDoubt, NothingChangesWithoutDoubt) {
  load("calendar");
  process({});
  const auto expected = results;
  for (const char* const way : {"pass-through", "hold"}) {
    results.clear();
    Options options;
    options.on_doubt = way;
    process(options);
    for (std::size_t i = 0; i < results.size(); ++i) {
      EXPECT_EQ(results[i].picture, expected[i].picture);
      EXPECT_EQ(results[i].provenance, expected[i].provenance);
    }
  }
}

/// Frames by hand.
class HeldPicture : public ::testing::Test {
 protected:
  static constexpr Rect object{2, 2, 3, 3};

  /// Returns the level that the picture shows on the object.
  int show(double stamp_s, std::uint8_t level, bool in_doubt) {
    FrameSet frame;
    frame.stamp_s = stamp_s;
    frame.color.own().resize(8, 8, Bgr{1, 1, 1});
    DiminishedFrame result;
    result.picture.resize(8, 8, Bgr{level, level, level});
    result.mask.resize(8, 8, 0);
    result.mask.fill(object, 255);
    result.provenance.resize(8, 8, 0);
    result.provenance.fill(object, 1);
    result.objects = object;
    result.report.in_doubt = in_doubt;
    Options options;
    options.on_doubt = "hold";
    doubt.act(frame, options, result);
    // What is shown, and where it is said to come from, agree.
    EXPECT_EQ(result.provenance(3, 3), result.picture(3, 3).b == 1 ? 0 : 1);
    return result.picture(3, 3).b;
  }

  Doubt doubt;
};

TEST_F(HeldPicture, IsTheLastGoodOne) {
  EXPECT_EQ(show(0, 50, true), 1);  // there was none
  EXPECT_EQ(show(0.1, 60, false), 60);
  EXPECT_EQ(show(0.2, 70, true), 60);
  EXPECT_EQ(show(0.3, 80, true), 60);
  EXPECT_EQ(show(0.4, 90, false), 90);
  EXPECT_EQ(show(0.5, 100, true), 90);
}

TEST_F(HeldPicture, IsNotHeldForLong) {
  EXPECT_EQ(show(0, 60, false), 60);
  EXPECT_EQ(show(0.5, 70, true), 60);
  EXPECT_EQ(show(0.6, 80, true), 1);
  // A recording that begins anew
  EXPECT_EQ(show(-1, 80, true), 1);
  EXPECT_EQ(show(0.1, 90, false), 90);
  doubt.forget();
  EXPECT_EQ(show(0.2, 100, true), 1);
}

}  // namespace
}  // namespace diminish
