#include "setup/calibrate/rig_repair.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <numbers>

#include "diminish/frame_source.h"
#include "diminish/options.h"
#include "expect_error.h"
#include "paths.h"
#include "run_program.h"
#include "setup/calibrate/rig_file.h"
#include "source/read_rigid_transform.h"
#include "source/tiny_recording.h"
#include "temporary_folder.h"
#include "truth_poses.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

/// The first frame of a bundled recording, as of cameras that are fixed to one another.
class RigRepairTest : public ::testing::TestWithParam<const char*> {
 protected:
  RigRepairTest() {
    recording = load_recording(std::filesystem::path(testing::recordings_dir()) / GetParam());
    open_recording(recording, Options{})->next(frame);
    const Poses poses = TruthPoses(recording.folder).poses(0, recording.rig);
    for (const auto& pose : poses.color_from_depth) {
      truth.push_back(*pose);
    }
  }

  /// Writes a rig whose cameras were calibrated before each was turned about its own centre.
  void write_bumped(const std::filesystem::path& rig, double degrees, const Eigen::Vector3d& axis,
                    const Eigen::Vector3d& moved_m) const {
    const RigidTransform bump{
        Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()).toRotationMatrix(),
        moved_m};
    RigFile file(rig, recording.folder / "rig.yaml");
    std::vector<std::pair<std::string, RigidTransform>> poses;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      poses.emplace_back(recording.rig.rgbd[k].name, truth[k] * bump);
    }
    file.set_fixed_poses(poses);
    file.write();
  }
  Rig bumped(double degrees, const Eigen::Vector3d& axis, const Eigen::Vector3d& moved_m) const {
    const TemporaryFolder folder;
    write_bumped(folder.path() / "rig.yaml", degrees, axis, moved_m);
    return load_rig(folder.path() / "rig.yaml");
  }

  /// How far points that RGB-D camera k sees a metre away are off in the picture, pixels (rms).
  double error_px(const RigidTransform& color_from_rgbd, std::size_t k) const {
    double squares = 0;
    int count = 0;
    for (const double x : {-0.3, 0., 0.3}) {
      for (const double y : {-0.2, 0., 0.2}) {
        const Eigen::Vector3d point(x, y, 1);
        const auto expected = Lens(recording.rig.color).project(truth[k] * point);
        const auto found = Lens(recording.rig.color).project(color_from_rgbd * point);
        if (!expected || !found) continue;
        squares += (*expected - *found).squaredNorm();
        ++count;
      }
    }
    return std::sqrt(squares / count);
  }

  Recording recording;
  FrameSet frame;
  std::vector<RigidTransform> truth;
};

INSTANTIATE_TEST_SUITE_P(Recordings, RigRepairTest,
                         ::testing::Values("calendar", "workbench", "ball"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST_P(RigRepairTest, FindsABumpedCameraAgain) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0.3, 0), Eigen::Vector3d(0.5, -1, 1)}) {
    const Rig rig = bumped(2.3, axis, {0.01, 0, -0.01});
    RigRepair repair(rig, recording.scene);
    repair.add(frame);
    const auto repaired = repair.repair();
    ASSERT_EQ(repaired.size(), truth.size());
    for (std::size_t k = 0; k < repaired.size(); ++k) {
      EXPECT_EQ(repaired[k].camera, rig.rgbd[k].name);
      EXPECT_GT(repaired[k].fit, 0.85);
      EXPECT_LT(repaired[k].fit_before, 0.7);
      EXPECT_LT(error_px(repaired[k].color_from_rgbd, k), 4);
    }
  }
}

TEST_P(RigRepairTest, LeavesAGoodPoseAsItIs) {
  const Rig rig = bumped(0, Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero());
  RigRepair repair(rig, recording.scene);
  repair.add(frame);
  for (const RepairedPose& pose : repair.repair()) {
    EXPECT_LT(pose.turned_deg, 0.2);
    EXPECT_LT(pose.moved_m, 0.01);
    EXPECT_GT(pose.fit, pose.fit_before - 0.04);
  }
}

TEST_P(RigRepairTest, TheProgramWritesWhatItFinds) {
  const TemporaryFolder folder;
  for (const auto& entry : std::filesystem::directory_iterator(recording.folder)) {
    const std::string name = entry.path().filename().string();
    if (name == "rig.yaml" || name == "color.txt") continue;
    std::filesystem::create_symlink(entry.path(), folder.path() / name);
  }
  std::string first;
  std::ifstream list(recording.folder / "color.txt");
  while (first.empty() || first[0] == '#') std::getline(list, first);
  folder.write("color.txt", first + "\n");
  write_bumped(folder.path() / "rig.yaml", 2, {0, 1, 0}, {0, 0, 0});
  const std::string out = (folder.path() / "mended.yaml").string();
  const auto run =
      Program::run({"calibrate", "rig", folder.path().string(), "--repair", "--out", out});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr(recording.rig.rgbd[0].name + ": turned by "));
  const Rig mended = load_rig(out);
  const Config poses = mended.pose.at("color_from_rgbd");
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_LT(error_px(read_rigid_transform(poses.at(mended.rgbd[k].name)), k), 4);
  }
}

/// Cameras that stand still: the recording's first frame for ever.
TEST_P(RigRepairTest, TheProgramMendsFromLivePictures) {
  const TemporaryFolder folder;
  std::filesystem::copy(recording.folder / "scene.yaml", folder.path());
  for (const auto& entry : std::filesystem::directory_iterator(recording.folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() || name.ends_with(".obj")) {
      std::filesystem::create_symlink(entry.path(), folder.path() / name);
    }
    if (!name.ends_with(".txt")) continue;
    std::ifstream list(entry.path());
    std::string stamp_s;
    std::string image;
    while (stamp_s.empty() || stamp_s[0] == '#') list >> stamp_s&& std::getline(list, image);
    image.erase(0, 1);
    // A frame's name is unique.
    const std::string again = "again" + std::filesystem::path(image).extension().string();
    std::filesystem::create_symlink(recording.folder / image, folder.path() / (name + "_" + again));
    folder.write(name, "1 " + image + "\n1.1 " + name + "_" + again + "\n");
  }
  write_bumped(folder.path() / "rig.yaml", 2, {0, 1, 0}, {0, 0, 0});
  const std::string replay = "recording:" + folder.path().string() + "?loop";
  const std::string out = (folder.path() / "mended.yaml").string();
  std::vector<std::string> arguments = {
      "calibrate", "rig", folder.path().string(), "--repair", "--out", out, "--seconds", "10",
      "--color",   replay};
  for (std::size_t k = 0; k < truth.size(); ++k) {
    arguments.insert(arguments.end(), {"--rgbd", replay});
  }
  const auto run = Program::run(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  const Rig mended = load_rig(out);
  const Config poses = mended.pose.at("color_from_rgbd");
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_LT(error_px(read_rigid_transform(poses.at(mended.rgbd[k].name)), k), 4);
  }
}

// A live camera's images come late now and then, mostly in the beginning.
TEST_P(RigRepairTest, FramesWithoutAllImagesAreNotLookedAt) {
  RigRepair repair(bumped(2.3, Eigen::Vector3d::UnitY(), {0, 0, 0}), recording.scene);
  FrameSet incomplete = frame;
  incomplete.rgbd.back().missing = "late";
  for (int i = 0; i < 3; ++i) repair.add(incomplete);
  EXPECT_EQ(repair.frames(), 0U);
  EXPECT_THAT(error_of([&] { repair.repair(); }),
              HasSubstr(recording.rig.rgbd.back().name + ": expected frames with its images"));
  repair.add(frame);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_LT(error_px(repair.repair()[k].color_from_rgbd, k), 4);
  }
}

TEST(RigRepairOf, PosesThatAreNotFixedIsRefused) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "calendar");
  EXPECT_THAT(error_of([&] { RigRepair(recording.rig, recording.scene); }),
              HasSubstr("pose.source: expected fixed to repair; got marker"));
}

TEST(RigRepairOf, ARigWithoutRgbdCamerasIsRefusedAndNothingIsWritten) {
  const TinyRecording recording;
  recording.write("rig.yaml",
                  "color: {width: 40, height: 30, camera_matrix: [40, 40, 20, 15],"
                  " distortion: [0, 0, 0, 0, 0]}\n"
                  "rgbd: []\n"
                  "pose: {source: fixed}\n");
  const std::string out = recording.path("mended.yaml").string();
  const auto run =
      Program::run({"calibrate", "rig", recording.path("").string(), "--repair", "--out", out});
  EXPECT_EQ(run.exit_code, 1) << run.out;
  EXPECT_THAT(run.err, HasSubstr("rgbd: expected an RGB-D camera whose pose to repair"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace diminish
