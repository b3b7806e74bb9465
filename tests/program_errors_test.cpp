#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "masked_recording.h"
#include "run_program.h"

namespace diminish {
namespace {

/// A way to damage a recording, and the error that the program must report.
struct Spoilt {
  const char* name;
  std::function<void(const MaskedRecording&)> spoil;
  std::vector<std::string> mentions;
  std::vector<std::string> flags = {};
};
void PrintTo(const Spoilt& spoilt, std::ostream* stream) {
  *stream << spoilt.name;
}

class ProgramErrors : public ::testing::TestWithParam<Spoilt> {};

TEST_P(ProgramErrors, AreOneLineThatNamesFileAndExpectation) {
  const MaskedRecording recording;
  GetParam().spoil(recording);
  std::vector<std::string> arguments = {"run", recording.folder(), "--out", recording.out()};
  arguments.insert(arguments.end(), GetParam().flags.begin(), GetParam().flags.end());
  const auto outcome = Program::run(arguments);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err.rfind("diminish: ", 0), 0U) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& text : GetParam().mentions) {
    EXPECT_THAT(outcome.err, ::testing::HasSubstr(text));
  }
}

Spoilt rig(const char* name, const char* from, const char* to, std::vector<std::string> mentions) {
  mentions.emplace_back("rig.yaml:");
  return {name, [=](const MaskedRecording& recording) { recording.spoil_rig(from, to); }, mentions};
}
Spoilt scene(const char* name, const char* yaml, std::vector<std::string> mentions) {
  mentions.emplace_back("scene.yaml");
  return {name, [=](const MaskedRecording& recording) { recording.write("scene.yaml", yaml); },
          mentions};
}
Spoilt images(const char* name, const char* stream, const cv::Mat& image,
              const std::vector<std::string>& mentions) {
  return {name,
          [=](const MaskedRecording& recording) {
            for (const char* file : {"/0.png", "/1.png", "/2.png"}) {
              recording.write(stream + std::string(file), image);
            }
          },
          mentions};
}
Spoilt flags(const char* name, std::vector<std::string> flags, std::vector<std::string> mentions) {
  return {name, [](const MaskedRecording&) {}, std::move(mentions), std::move(flags)};
}
const auto remove_file = [](const char* file) {
  return [=](const MaskedRecording& recording) { std::filesystem::remove(recording.path(file)); };
};

INSTANTIATE_TEST_SUITE_P(
    All, ProgramErrors,
    ::testing::Values(
        rig("MissingKey", "depth_unit_m: 0.001\n", "\n", {"depth_unit_m"}),
        rig("MisspeltKey", "depth_unit_m", "depth_units", {"depth_units"}),
        rig("NotANumber", "[40, 40, 20, 15]", "[40, .nan, 20, 15]", {"camera_matrix"}),
        rig("SingularMatrix", "rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1]",
            "rotation: [1, 0, 0, 0, 1, 0, 0, 0, 0]", {"color_from_depth.rotation", "rotation"}),
        rig("UnknownPoseSource", "source: fixed", "source: sextant", {"pose.source", "marker"}),
        rig("NotYaml", "color: {", "color: {{", {}),
        scene("UnknownDetector", "occluders: [{name: a, detector: nose}]\n",
              {"occluders[0].detector", "marker", "nose"}),
        scene("NoMarker", "occluders: [{name: a, detector: marker, vertices: [[0, 0, 0]]}]\n",
              {"occluders[0]", "marker"}),
        Spoilt{"MeshWithoutFaces",
               [](const MaskedRecording& recording) {
                 recording.write("lamp.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
                 recording.write("scene.yaml",
                                 "occluders: [{name: lamp, detector: marker, "
                                 "marker: {id: 2, size_m: 0.1}, mesh: lamp.obj}]\n");
               },
               {"lamp.obj", "face"}},
        Spoilt{"NoRig", remove_file("rig.yaml"), {"rig.yaml"}},
        Spoilt{"NoScene", remove_file("scene.yaml"), {"scene.yaml"}},
        Spoilt{"NoList", remove_file("rgbd0_depth.txt"), {"rgbd0_depth.txt"}},
        Spoilt{"EmptyRecording",
               [](const MaskedRecording& recording) { recording.write("color.txt", "# none\n"); },
               {"color.txt"}},
        images("ColorOfAnotherSize", "color", cv::Mat(20, 20, CV_8UC3, cv::Scalar(0)),
               {"color/0.png", "40x30", "20x20"}),
        images("DepthOf8Bit", "rgbd0_depth", cv::Mat(24, 32, CV_8UC1, cv::Scalar(9)),
               {"rgbd0_depth/0.png", "16-bit", "8-bit"}),
        flags("UnknownDetectorFlag", {"--detector", "nose"}, {"--detector", "difference", "nose"}),
        flags("DetectorThatNeedsSettings", {"--detector", "marker"}, {"--detector", "marker"}),
        flags("UnknownMethod", {"--inpaint", "magic"}, {"inpaint", "telea", "magic"}),
        flags("OptionOutOfRange", {"--mask-margin-px", "-1"}, {"mask_margin_px", "-1"})),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ProgramErrorsToo, ARecordingThatIsNotThere) {
  const auto outcome = Program::run({"run", "/nowhere", "--out", "/tmp/never"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("/nowhere"));
}

TEST(ProgramErrorsToo, TheRecordingIsNoPlaceForResults) {
  const MaskedRecording recording;
  const auto outcome =
      Program::run({"run", recording.folder(), "--out", recording.folder(), "--force"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("--out"));
  EXPECT_TRUE(std::filesystem::exists(recording.path("color/0.png")));
}

}  // namespace
}  // namespace diminish
