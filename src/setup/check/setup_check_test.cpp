#include "diminish/setup_check.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"
#include "core/text.h"
#include "paths.h"
#include "run_program.h"

namespace diminish {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A demo recording that can be damaged: small files are copied, images linked.
class Copy {
 public:
  explicit Copy(const std::string& name) {
    const fs::path source = fs::path(testing::recordings_dir()) / name;
    for (const auto& entry : fs::recursive_directory_iterator(source)) {
      const fs::path to = path() / fs::relative(entry.path(), source);
      if (entry.is_directory()) {
        fs::create_directories(to);
      } else if (entry.path().extension() == ".yaml" || entry.path().extension() == ".txt") {
        fs::copy_file(entry.path(), to);
      } else {
        fs::create_symlink(fs::absolute(entry.path()), to);
      }
    }
  }

  fs::path path() const { return folder_.path(); }

  /// Replaces the `count`th occurrence of a text, 0 being the first; all of them if it is -1.
  void replace(const std::string& file, const std::string& from, const std::string& to,
               int count = 0) const {
    std::string text = read_text_file(path() / file, 1 << 20);
    std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    for (int i = 0; at != std::string::npos; ++i) {
      if (count < 0 || i == count) text.replace(at, from.size(), to);
      at = text.find(from, at + to.size());
    }
    folder_.write(file, text);
  }
  /// Changes every image of a folder.
  void change(const std::string& images, const std::function<void(cv::Mat&)>& change) const {
    for (const auto& entry : fs::directory_iterator(path() / images)) {
      cv::Mat image = cv::imread(entry.path().string(), cv::IMREAD_UNCHANGED);
      change(image);
      fs::remove(entry.path());
      cv::imwrite(entry.path().string(), image, {cv::IMWRITE_JPEG_QUALITY, 95});
    }
  }
  void exchange(const std::string& a, const std::string& b) const {
    const std::string text = read_text_file(path() / a, 1 << 20);
    folder_.write(a, read_text_file(path() / b, 1 << 20));
    folder_.write(b, text);
  }
  /// Adds to the timestamps of a list.
  void shift(const std::string& list, double seconds) const {
    std::string shifted;
    std::istringstream lines(read_text_file(path() / list, 1 << 20));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t space = line.find(' ');
      const auto stamp = parse_number(line.substr(0, space));
      if (stamp) line = fmt::format("{:.6f}{}", *stamp + seconds, line.substr(space));
      shifted += line + "\n";
    }
    folder_.write(list, shifted);
  }

  SetupReport check() const {
    const Recording recording = load_recording(path());
    const auto source = open_recording(recording, Options{});
    return check_setup(recording.rig, recording.scene, *source);
  }

 private:
  TemporaryFolder folder_;
};

std::string describe(const SetupReport& report) {
  return setup_report_text(report);
}

struct Spoilt {
  const char* name;
  const char* recording;
  std::function<void(const Copy&)> spoil;
  const char* code;      ///< of the only serious finding
  const char* mentions;  ///< what it must name
};
void PrintTo(const Spoilt& spoilt, std::ostream* stream) {
  *stream << spoilt.name;
}

class SpoiltSetup : public ::testing::TestWithParam<Spoilt> {};

// With one thing wrong at a time, the check reports it and nothing else that is serious.
TEST_P(SpoiltSetup, IsFound) {
  const Copy copy(GetParam().recording);
  GetParam().spoil(copy);
  const SetupReport report = copy.check();
  std::vector<Finding> serious;
  for (const Finding& finding : report.findings) {
    if (finding.severity == Finding::Severity::serious) serious.push_back(finding);
  }
  ASSERT_GE(serious.size(), 1U) << describe(report);
  for (const Finding& finding : serious) {
    EXPECT_EQ(finding.code, GetParam().code) << describe(report);
    EXPECT_FALSE(finding.figure.empty());
    EXPECT_FALSE(finding.remedy.empty());
  }
  EXPECT_THAT(serious.front().what + " " + serious.front().remedy, HasSubstr(GetParam().mentions))
      << describe(report);
}

const auto flip = [](cv::Mat& image) { cv::flip(image, image, 1); };
const auto darken = [](cv::Mat& image) { image *= 0.12; };
constexpr const char* color_focal_lengths = "camera_matrix: [1131.4, 1130.7,";
constexpr const char* rgbd_focal_lengths = "camera_matrix: [1059.8, 1060.2,";

INSTANTIATE_TEST_SUITE_P(
    All, SpoiltSetup,
    ::testing::Values(
        Spoilt{"WorldMarkerSize", "calendar",
               [](const Copy& c) { c.replace("scene.yaml", "size_m: 0.2}", "size_m: 0.25}"); },
               "marker-size", "marker 0 is not 250.0 mm"},
        Spoilt{"WorldMarkerSizeBall", "ball",
               [](const Copy& c) { c.replace("scene.yaml", "size_m: 0.2}", "size_m: 0.16}"); },
               "marker-size", "marker 0"},
        Spoilt{"WorldMarkerSizeWorkbench", "workbench",
               [](const Copy& c) { c.replace("scene.yaml", "size_m: 0.2}", "size_m: 0.22}"); },
               "marker-size", "marker 0"},
        Spoilt{"ObjectsMarkerSize", "calendar",
               [](const Copy& c) { c.replace("scene.yaml", "size_m: 0.12}", "size_m: 0.1}"); },
               "marker-size", "marker 1 is not 100.0 mm"},
        Spoilt{"DepthUnitTimesTen", "calendar",
               [](const Copy& c) { c.replace("rig.yaml", "unit_m: 0.001", "unit_m: 0.01"); },
               "depth-unit", "depth_unit_m: 0.001"},
        Spoilt{"DepthUnitATenth", "ball",
               [](const Copy& c) { c.replace("rig.yaml", "unit_m: 0.001", "unit_m: 0.0001"); },
               "depth-unit", "depth_unit_m: 0.001"},
        Spoilt{"DepthUnitOfOneCamera", "workbench",
               [](const Copy& c) { c.replace("rig.yaml", "unit_m: 0.001", "unit_m: 0.0002", 1); },
               "depth-unit", "rgbd1"},
        Spoilt{"SwappedDepth", "workbench",
               [](const Copy& c) { c.exchange("rgbd0_depth.txt", "rgbd1_depth.txt"); }, "swapped",
               "rgbd1"},
        Spoilt{"MirroredColor", "calendar", [](const Copy& c) { c.change("color", flip); },
               "mirrored", "color is mirrored"},
        Spoilt{"MirroredRgbdColor", "ball", [](const Copy& c) { c.change("rgbd0/color", flip); },
               "mirrored", "rgbd0 color"},
        Spoilt{"MirroredRgbd", "workbench",
               [](const Copy& c) {
                 c.change("rgbd1/color", flip);
                 c.change("rgbd1/depth", flip);
               },
               "mirrored", "rgbd1 color"},
        Spoilt{"MirroredDepth", "calendar", [](const Copy& c) { c.change("rgbd0/depth", flip); },
               "mirrored", "rgbd0 depth"},
        Spoilt{"ColorFocalLength", "calendar",
               [](const Copy& c) {
                 c.replace("rig.yaml", color_focal_lengths, "camera_matrix: [1244.5, 1243.8,");
               },
               "intrinsics", "focal length of color"},
        Spoilt{"ColorFocalLengthTooShort", "workbench",
               [](const Copy& c) {
                 c.replace("rig.yaml", color_focal_lengths, "camera_matrix: [1018.3, 1017.6,");
               },
               "intrinsics", "focal length of color"},
        Spoilt{"ColorFocalLengthWorkbench", "workbench",
               [](const Copy& c) {
                 c.replace("rig.yaml", color_focal_lengths, "camera_matrix: [1244.5, 1243.8,");
               },
               "intrinsics", "focal length of color"},
        Spoilt{"RgbdFocalLength", "calendar",
               [](const Copy& c) {
                 c.replace("rig.yaml", rgbd_focal_lengths, "camera_matrix: [1165.8, 1166.2,");
               },
               "intrinsics", "focal length of rgbd0 color"},
        Spoilt{"RgbdFocalLengthBall", "ball",
               [](const Copy& c) {
                 c.replace("rig.yaml", rgbd_focal_lengths, "camera_matrix: [953.8, 954.2,");
               },
               "intrinsics", "focal length of rgbd0 color"},
        Spoilt{"FocalLengthOfOneOfTwo", "workbench",
               [](const Copy& c) {
                 c.replace("rig.yaml", rgbd_focal_lengths, "camera_matrix: [1165.8, 1166.2,", 1);
               },
               "intrinsics", "focal length of rgbd1 color"},
        Spoilt{"Dictionary", "calendar",
               [](const Copy& c) { c.replace("scene.yaml", "DICT_4X4_50", "DICT_5X5_50"); },
               "dictionary", "marker_dictionary: DICT_4X4_50"},
        Spoilt{"DictionaryBall", "ball",
               [](const Copy& c) { c.replace("scene.yaml", "DICT_4X4_50", "DICT_APRILTAG_36h11"); },
               "dictionary", "marker_dictionary: DICT_4X4_50"},
        Spoilt{"WorldMarkersId", "ball",
               [](const Copy& c) { c.replace("scene.yaml", "id: 0", "id: 5"); },
               "marker-not-visible", "world marker 5"},
        Spoilt{"ObjectsMarkersId", "calendar",
               [](const Copy& c) { c.replace("scene.yaml", "{id: 1,", "{id: 9,"); },
               "marker-not-visible", "marker 9"},
        Spoilt{"OtherClock", "calendar",
               [](const Copy& c) {
                 c.shift("rgbd0_color.txt", 100);
                 c.shift("rgbd0_depth.txt", 100);
               },
               "no-partner", "rgbd0"}),
    [](const auto& test) { return std::string(test.param.name); });

// Cameras of the same kind with fixed poses: only their poses tell them apart.
TEST(CheckSetup, FindsSwappedCamerasWithFixedPoses) {
  const Copy copy("workbench");
  const std::string rig = (copy.path() / "rig.yaml").string();
  const auto calibrated = Program::run({"calibrate", "rig", copy.path().string(), "--out", rig});
  ASSERT_THAT(calibrated.out, HasSubstr("Written to")) << calibrated.err;
  const SetupReport intact = copy.check();
  EXPECT_TRUE(intact.fine()) << describe(intact);
  copy.exchange("rgbd0_color.txt", "rgbd1_color.txt");
  copy.exchange("rgbd0_depth.txt", "rgbd1_depth.txt");
  const SetupReport report = copy.check();
  ASSERT_FALSE(report.fine());
  for (const Finding& finding : report.findings)
    EXPECT_EQ(finding.code, "swapped") << describe(report);
}

class IntactSetup : public ::testing::TestWithParam<const char*> {};

TEST_P(IntactSetup, GivesNoFinding) {
  const Copy copy(GetParam());
  const SetupReport report = copy.check();
  EXPECT_TRUE(report.fine()) << describe(report);
  EXPECT_GT(report.frames, 0U);
}

INSTANTIATE_TEST_SUITE_P(All, IntactSetup, ::testing::Values("calendar", "ball", "workbench"));

TEST(CheckSetup, WarnsOfImagesThatAreTooDarkOrTooBright) {
  const Copy copy("ball");
  copy.change("rgbd0/color", darken);
  copy.change("color", [](cv::Mat& image) { image.convertTo(image, -1, 1, 140); });
  const SetupReport report = copy.check();
  std::vector<std::string> codes;
  for (const Finding& finding : report.findings) codes.push_back(finding.code);
  EXPECT_THAT(codes, ::testing::Contains("dark"));
  EXPECT_THAT(codes, ::testing::Contains("overexposed"));
}

// In a quarter of the frames: often enough to stop the picture, not often enough to be noticed.
TEST(CheckSetup, WarnsOfAWorldMarkerThatIsHiddenNowAndThen) {
  const Copy copy("calendar");
  int image = 0;
  copy.change("rgbd0/color", [&](cv::Mat& picture) {
    if (++image % 4 == 0) picture.setTo(cv::Scalar(90, 90, 90));
  });
  const SetupReport report = copy.check();
  ASSERT_EQ(report.findings.size(), 1U) << describe(report);
  EXPECT_EQ(report.findings[0].code, "marker-not-visible");
  EXPECT_THAT(report.findings[0].what, HasSubstr("not always visible in rgbd0"));
}

TEST(CheckProgram, SaysItOnTheTerminalAndAsJson) {
  const Copy copy("ball");
  const std::string json = (copy.path() / "report.json").string();
  const auto fine = Program::run({"check", copy.path().string()});
  EXPECT_EQ(fine.exit_code, 0) << fine.err;
  EXPECT_THAT(fine.out, HasSubstr("no problems found"));
  copy.replace("rig.yaml", "unit_m: 0.001", "unit_m: 0.01");
  const auto wrong = Program::run({"check", copy.path().string(), "--json", json});
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_THAT(wrong.out, AllOf(HasSubstr("[serious] depth-unit"), HasSubstr("to do:")));
  const auto report = nlohmann::json::parse(read_text_file(json, 1 << 20));
  EXPECT_EQ(report["findings"][0]["code"], "depth-unit");
  EXPECT_EQ(report["frames"], 3);
  const auto missing = Program::run({"check", "/nowhere"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, HasSubstr("/nowhere"));
}

}  // namespace
}  // namespace diminish
