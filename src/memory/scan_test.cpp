#include "diminish/scan.h"

#include <gmock/gmock.h>

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>

#include "core/text.h"
#include "diminish/occluder_settings.h"
#include "expect_error.h"
#include "memory_test_scene.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;
using testing::hidden;

class ScanTest : public testing::MemoryTest {
 protected:
  ScanTest() {
    folder_.write("scene.yaml",
                  "world_marker: {id: 7, size_m: 0.2}\n"
                  "occluders: [{name: board, detector: mask, color: masks}]\n");
    scene = load_scene(folder_.path() / "scene.yaml");
    std::filesystem::create_directories(folder_.path() / "masks");
    const cv::Mat none(rig.color.height, rig.color.width, CV_8UC1, cv::Scalar(0));
    cv::imwrite((folder_.path() / "masks/000000.png").string(), none);
  }

  std::filesystem::path path(const std::string& name) const { return room() / name; }
  std::filesystem::path room() const { return folder_.path() / "room"; }

  /// What the memory holds, through files, as the only thing that another one knows.
  void scan_and_begin_anew(const Rig& later) {
    save_scan(memory.scan(scene), folder_.path() / "scene.yaml", room());
    MemoryStage other(later);
    other.set_background(load_scan(room()), scene);
    memory.share(other);
  }
  std::string error_after(const std::string& file, const std::string& from, const std::string& to) {
    std::string text = read_text_file(path(file), 1 << 20);
    const std::string before = text;
    text.replace(text.find(from), from.size(), to);
    folder_.write("room/" + file, text);
    const std::string message = error_of([&] { load_scan(room()); });
    folder_.write("room/" + file, before);
    return message;
  }

  TemporaryFolder folder_;
  Scene scene;
};

TEST_F(ScanTest, IsRememberedInAnotherSession) {
  show({.stamp_s = 5000});
  scan_and_begin_anew(rig);
  // Another clock, and long after: a scan does not age.
  options.memory_max_age_s = 1;
  const Reconstruction& shown = show({.stamp_s = 3, .object = hidden, .is_witnessed = false});
  EXPECT_GT(count(shown, provenance::remembered), pixels * 9 / 10);
  EXPECT_LT(error(shown, provenance::remembered), 5);
  EXPECT_EQ(memory_report.background_pixels, count(shown, provenance::remembered));
  EXPECT_EQ(memory_report.oldest_age_s, 0);
}

TEST_F(ScanTest, HoldsNoObjectsToRemove) {
  show({.stamp_s = 0, .object = hidden});
  const Scan scan = memory.scan(scene);
  ASSERT_EQ(scan.frames.size(), 1U);
  const RgbdFrame& images = scan.frames[0].frame.rgbd[0];
  const Intrinsics& grid = scan.rig.rgbd[0].depth;
  const int step = rig.color.width / grid.width;
  std::size_t known = 0;
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      if (hidden.contains(x * step, y * step)) {
        EXPECT_EQ(images.depth(x, y), 0);
      }
      known += images.depth(x, y) > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(known, static_cast<std::size_t>(grid.width) * grid.height / 4);
}

TEST_F(ScanTest, IsWitnessedByTheSameCamera) {
  show({.stamp_s = 0});
  scan_and_begin_anew(rig);
  const Reconstruction& shown = show({.stamp_s = 0.3, .object = hidden});
  EXPECT_GT(count(shown, provenance::witnessed), pixels * 7 / 10);
  EXPECT_LT(error(shown, provenance::witnessed), 3);
}

TEST_F(ScanTest, IsForgottenWhereTheSameCameraSeesItGone) {
  show({.stamp_s = 0});
  scan_and_begin_anew(rig);
  EXPECT_LT(count_box(show({.stamp_s = 0.3, .has_box = false, .object = hidden})), 100);
  EXPECT_LT(
      count_box(show({.stamp_s = 0.6, .has_box = false, .object = hidden, .is_witnessed = false})),
      100);
}

TEST_F(ScanTest, IsNotShownWhereACameraThatWasNotThereSeesItGone) {
  show({.stamp_s = 0});
  Rig later = rig;
  later.rgbd[0].name = "another";
  scan_and_begin_anew(later);
  EXPECT_GT(count_box(show({.stamp_s = 0.3, .object = hidden, .is_witnessed = false})), 2500);
  EXPECT_LT(count_box(show({.stamp_s = 0.6, .has_box = false, .object = hidden})), 100);
}

TEST_F(ScanTest, SurvivesARecordingThatBeginsAnewButNotForgetting) {
  show({.stamp_s = 0});
  scan_and_begin_anew(rig);
  show({.stamp_s = 10, .object = hidden});
  show({.stamp_s = 0, .object = hidden, .is_witnessed = false});
  EXPECT_GT(count(result, provenance::remembered), pixels * 9 / 10);
  memory.forget();
  show({.stamp_s = 0.3, .object = hidden, .is_witnessed = false});
  EXPECT_EQ(count(result, provenance::remembered), 0U);
}

TEST_F(ScanTest, SaysWhatIsWrongWithAFolder) {
  show({.stamp_s = 0});
  scan_and_begin_anew(rig);
  EXPECT_THAT(error_after("rig.yaml", "name: memory", "name: rgbd7"),
              HasSubstr("room/rig.yaml: rgbd: expected a scan"));
  EXPECT_THAT(error_after("rig.yaml", "{width: 320, height: 256, camera_matrix: [283",
                          "{width: 322, height: 256, camera_matrix: [283"),
              HasSubstr("rig.yaml: rgbd[0].depth: expected 322x256"));
  EXPECT_THAT(error_after("color_poses.txt", "0.000000 ", "0.000000 nan "),
              HasSubstr("color_poses.txt:2: expected a finite number"));
  EXPECT_THAT(error_after("color_poses.txt", "0.000000 ", "7.000000 "),
              HasSubstr("no pose of color within"));
  EXPECT_THAT(error_after("memory_depth.txt", "0.000000 ", "7.000000 "),
              HasSubstr("memory: no depth image within"));
  std::string list = read_text_file(path("color.txt"), 1 << 20);
  for (int i = 1; i < 20; ++i) list += fmt::format("{}.0 color/{:06}.png\n", i, i);
  folder_.write("room/color.txt", list);
  EXPECT_THAT(error_of([&] { load_scan(room()); }),
              HasSubstr("room/color.txt: expected at most 16 images, got 20"));
  std::filesystem::remove(path("memory/depth/000000.png"));
  EXPECT_THAT(error_of([&] { load_scan(room()); }), HasSubstr("memory_depth.txt: none of its 1"));
}

TEST_F(ScanTest, MustBeOfTheSameCameraAndWorld) {
  show({.stamp_s = 0});
  const Scan scan = memory.scan(scene);
  MemoryStage other(rig);
  Scene elsewhere = scene;
  elsewhere.world_marker.id = 8;
  EXPECT_EQ(error_of([&] { other.set_background(scan, elsewhere); }),
            "the background: world_marker: expected {id: 8, size_m: 0.2} of DICT_4X4_50 as in this "
            "scene, got {id: 7, size_m: 0.2} of DICT_4X4_50");
  Rig another = rig;
  another.color.fx += 1;
  EXPECT_THAT(error_of([&] { MemoryStage(another).set_background(scan, scene); }),
              HasSubstr("color: expected the size and lens"));
  Rig bolted = rig;
  bolted.pose_source = "fixed";
  EXPECT_THAT(error_of([&] { MemoryStage(bolted).set_background(scan, scene); }),
              HasSubstr("expected marker or file"));
  EXPECT_THAT(error_of([&] { MemoryStage(bolted).scan(scene); }), HasSubstr("source"));
  Scan damaged = scan;
  damaged.frames[0].poses.color_from_world.reset();
  EXPECT_THAT(error_of([&] { other.set_background(damaged, scene); }),
              HasSubstr("frame '000000': expected a pose"));
}

}  // namespace
}  // namespace diminish
