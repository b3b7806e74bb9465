#include <fmt/format.h>
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "core/text.h"
#include "diminish/config.h"
#include "rendered_targets.h"
#include "run_program.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

const Intrinsics truth{480, 360, 417.2, 416.1, 242.0, 177.1, {-0.15, 0.06, 0, 0, 0}};
const std::string board_text = "charuco:7x5:30:22:DICT_4X4_50";

RigidTransform lean(double x, double y) {
  RigidTransform pose;
  pose.rotation = (Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX()) *
                   Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix() *
                  Eigen::Vector3d(1, -1, -1).asDiagonal();
  pose.translation = {0.15 * y, -0.1 * x, 0.33 + 0.1 * x * y};
  return pose;
}

/// A folder of pictures of a board, as a recording's stream too.
class CalibrateProgram : public ::testing::Test {
 protected:
  CalibrateProgram() {
    const Board board = parse_board(board_text);
    const testing::TargetRenderer renderer(truth);
    std::string list;
    std::filesystem::create_directories(folder.path() / "color");
    for (int i = 0; i < 9; ++i) {
      const auto image =
          renderer.color({testing::board_target(board, lean(0.5 * (i % 3 - 1), 0.5 * (i / 3 - 1)))},
                         {}, 0.6, 2, static_cast<unsigned>(i));
      write(fmt::format("color/{}.png", i), as_mat(image));
      list += fmt::format("{} color/{}.png\n", i, i);
    }
    write("color/again.png", cv::imread((folder.path() / "color/0.png").string()));
    write("color/grey.png", cv::Mat(360, 480, CV_8UC3, cv::Scalar::all(90)));
    write("color/small.png", cv::Mat(100, 100, CV_8UC3, cv::Scalar::all(90)));
    folder.write("color/broken.png", "no picture");
    folder.write("color.txt", list);
  }
  void write(const std::string& name, const cv::Mat& image) {
    cv::imwrite((folder.path() / name).string(), image);
  }
  std::string path(const std::string& name) const { return (folder.path() / name).string(); }
  Config load_rig_file() const { return Config::load(folder.path() / "rig.yaml"); }

  TemporaryFolder folder;
};

TEST_F(CalibrateProgram, SaysOfEachImageWhatItWasGoodForAndWritesTheRig) {
  folder.write("rig.yaml", "# my rig\nrgbd: []   # to come\n");
  const auto outcome =
      Program::run({"calibrate", "intrinsics", path("color"), "--board", board_text, "--out",
                    path("rig.yaml"), "--plot", path("plot.png")});
  EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("broken.png: not used: cannot be decoded"));
  EXPECT_THAT(outcome.out, HasSubstr("grey.png: not used: the board was not found"));
  EXPECT_THAT(outcome.out, HasSubstr("small.png: not used: expected 480x360"));
  EXPECT_THAT(outcome.out, HasSubstr("again.png: not used: shows the board like"));
  EXPECT_THAT(outcome.out, HasSubstr("coverage"));
  EXPECT_EQ(outcome.exit_code == 3, outcome.out.find("Warning:") != std::string::npos);
  const auto matrix = load_rig_file().at("color").at("camera_matrix").numbers(4);
  EXPECT_NEAR(matrix[0], truth.fx, 0.015 * truth.fx);
  EXPECT_NEAR(matrix[1], truth.fy, 0.015 * truth.fy);
  EXPECT_THAT(read_text_file(path("rig.yaml"), 1 << 20),
              HasSubstr("# my rig\nrgbd: []   # to come\n"));
  EXPECT_EQ(cv::imread(path("plot.png")).cols, 800);
}

TEST_F(CalibrateProgram, TakesARecordingAndTheSameImagesGiveTheSameBytes) {
  std::vector<std::string> images = {"calibrate", "intrinsics", "--board",
                                     board_text,  "--out",      path("a.yaml")};
  for (int i = 0; i < 9; ++i) images.push_back(path(fmt::format("color/{}.png", i)));
  const auto from_images = Program::run(images);
  const auto from_recording =
      Program::run({"calibrate", "intrinsics", "--board", board_text, "--recording",
                    folder.path().string(), "--out", path("b.yaml")});
  EXPECT_EQ(from_images.exit_code, from_recording.exit_code) << from_recording.err;
  EXPECT_EQ(read_text_file(path("a.yaml"), 1 << 20), read_text_file(path("b.yaml"), 1 << 20));
}

TEST_F(CalibrateProgram, FitsTheLensThatIsAskedFor) {
  for (const char* lens : {"rational", "fisheye"}) {
    const auto outcome = Program::run({"calibrate", "intrinsics", path("color"), "--board",
                                       board_text, "--lens", lens, "--out", path("rig.yaml")});
    EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 3) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("\nk4 "));
    const Config camera = load_rig_file().at("color");
    EXPECT_EQ(camera.at("distortion_model").text(), lens);
    EXPECT_NO_THROW(camera.at("distortion").numbers(lens == std::string("fisheye") ? 4 : 8));
    const auto matrix = camera.at("camera_matrix").numbers(4);
    EXPECT_NEAR(matrix[0], truth.fx, 0.03 * truth.fx) << lens;
  }
}

TEST_F(CalibrateProgram, WatchesALiveCamera) {
  // A camera that shows the nine pictures again and again, in real time.
  folder.write("rig.yaml", R"(
color: {width: 480, height: 360, camera_matrix: [400, 400, 240, 180], distortion: [0, 0, 0, 0, 0]}
rgbd:
  - name: rgbd0
    color: {width: 8, height: 8, camera_matrix: [8, 8, 4, 4], distortion: [0, 0, 0, 0, 0]}
    depth: {width: 8, height: 8, camera_matrix: [8, 8, 4, 4], distortion: [0, 0, 0, 0, 0]}
    depth_unit_m: 0.001
    color_from_depth: {rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1], translation: [0, 0, 0]}
)");
  const auto outcome =
      Program::run({"calibrate", "intrinsics", "--live",
                    "recording:" + folder.path().string() + "?loop&rate=3&camera=color", "--board",
                    board_text, "--seconds", "9", "--out", path("live.yaml")});
  EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 3) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("so far 9 views"));
  EXPECT_THAT(outcome.out, HasSubstr(" s: not used: shows the board like "));
  const auto matrix =
      Config::load(folder.path() / "live.yaml").at("color").at("camera_matrix").numbers(4);
  EXPECT_NEAR(matrix[0], truth.fx, 0.015 * truth.fx);
  EXPECT_NEAR(matrix[1], truth.fy, 0.015 * truth.fy);
}

TEST_F(CalibrateProgram, ErrorsAreOneLineAndChangeNothing) {
  folder.write("rig.yaml", "# mine\n");
  const auto error = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"calibrate", "intrinsics", "--out", path("rig.yaml")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto outcome = Program::run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(error({"--board", board_text}), HasSubstr("--recording"));
  EXPECT_THAT(error({"--board", "chess", path("color")}), HasSubstr("checkerboard:"));
  EXPECT_THAT(error({"--board", board_text, path("color"), "--camera", "left"}),
              HasSubstr("'left'"));
  EXPECT_THAT(error({"--board", board_text, path("color/grey.png")}), HasSubstr("got 0"));
  EXPECT_THAT(error({"--board", board_text, path("color/broken.png")}), HasSubstr("broken.png"));
  EXPECT_THAT(error({"--board", board_text, "--recording", path("color")}), HasSubstr("color.txt"));
  EXPECT_THAT(error({"--board", board_text, "--live", "v4l2:/dev/none"}),
              HasSubstr("v4l2:/dev/none: there is no such device"));
  EXPECT_THAT(error({"--board", board_text, path("color"), "--live", "v4l2:/dev/none"}),
              HasSubstr("--live"));
  EXPECT_EQ(read_text_file(path("rig.yaml"), 1 << 20), "# mine\n");
}

}  // namespace
}  // namespace diminish
