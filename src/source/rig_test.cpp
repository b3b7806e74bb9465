#include "diminish/rig.h"

#include <fstream>
#include <sstream>

#include "expect_error.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

/// A correct rig.yaml with one text replaced by another.
std::string rig_with(const std::string& text, const std::string& replacement) {
  std::string yaml =
      "color: {width: 640, height: 480, camera_matrix: [500, 501, 320, 240],"
      " distortion: [0.1, 0, 0, 0, 0]}\n"
      "rgbd:\n"
      "  - name: rgbd0\n"
      "    color: {width: 320, height: 240, camera_matrix: [250, 250, 160, 120],"
      " distortion: [0, 0, 0, 0, 0]}\n"
      "    depth: {width: 512, height: 424, camera_matrix: [365, 365, 255, 206],"
      " distortion: [0, 0, 0, 0, 0]}\n"
      "    depth_unit_m: 0.001\n"
      "    color_from_depth:\n"
      "      rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "      translation: [0.05, 0, 0]\n";
  const std::size_t at = yaml.find(text);
  EXPECT_NE(at, std::string::npos) << text;
  return yaml.replace(at, text.size(), replacement);
}

Rig read(const std::string& yaml) {
  return read_rig(Config::parse(yaml, "rig.yaml"));
}

std::string complaint(const std::string& text, const std::string& replacement) {
  return error_of([&] { read(rig_with(text, replacement)); });
}

TEST(Rig, ReadsTheBundledRigs) {
  const Rig rig = load_rig(testing::recordings_dir() + "/workbench/rig.yaml");
  EXPECT_EQ(rig.color.width, 1280);
  EXPECT_EQ(rig.color.cy, 507.8);
  EXPECT_EQ(rig.color.distortion[3], -0.0004);
  ASSERT_EQ(rig.rgbd.size(), 2U);
  EXPECT_EQ(rig.rgbd[1].name, "rgbd1");
  EXPECT_EQ(rig.rgbd[1].depth.height, 424);
  EXPECT_EQ(rig.rgbd[1].depth_unit_m, 0.001);
  EXPECT_NEAR(rig.rgbd[1].color_from_depth.rotation(0, 2), 0.006003944, 1e-8);
  EXPECT_EQ(rig.rgbd[1].color_from_depth.translation.x(), 0.051991962);
  EXPECT_EQ(rig.pose_source, "marker");
  EXPECT_FALSE(rig.pose.exists());
}

/// A rig with two cameras that measure no depth.
std::string color_only_rig(const std::string& item) {
  return rig_with("rgbd:\n", "cameras:\n" + item + "rgbd:\n");
}

TEST(Rig, CamerasWithoutDepthComeLast) {
  const std::string camera =
      "{width: 1920, height: 1080, camera_matrix: [1000, 1000, 959.5, 539.5],"
      " distortion: [0.1, 0, 0, 0, 0]}";
  const Rig rig =
      read(color_only_rig("  - {name: left, color: " + camera +
                          ", range_m: [0.5, 2]}\n  - {name: right, color: " + camera + "}\n"));
  ASSERT_EQ(rig.rgbd.size(), 3U);
  EXPECT_EQ(rig.rgbd[0].name, "rgbd0");
  EXPECT_TRUE(rig.rgbd[0].measures_depth);
  const RgbdCamera& left = rig.rgbd[1];
  EXPECT_EQ(left.name, "left");
  EXPECT_FALSE(left.measures_depth);
  EXPECT_EQ(left.nearest_m, 0.5);
  EXPECT_EQ(left.farthest_m, 2);
  // Half the size, without lens distortion, at the colour sensor's place
  EXPECT_EQ(left.depth.width, 960);
  EXPECT_EQ(left.depth.height, 540);
  EXPECT_EQ(left.depth.fx, 500);
  EXPECT_EQ(left.depth.cx, 479.5);
  EXPECT_EQ(left.depth.distortion[0], 0);
  EXPECT_TRUE(left.color_from_depth.translation.isZero());
}

TEST(Rig, WhatIsWrongWithACameraWithoutDepthIsNamed) {
  const std::string camera =
      "{width: 1920, height: 1080, camera_matrix: [1000, 1000, 959.5, 539.5],"
      " distortion: [0, 0, 0, 0, 0]}";
  const auto complaint_of = [&](const std::string& item) {
    return error_of([&] { read(color_only_rig("  - " + item + "\n")); });
  };
  EXPECT_THAT(complaint_of("{name: left, color: " + camera + ", range_m: [2, 1]}"),
              HasSubstr("cameras[0].range_m: expected the nearest and the farthest distance"));
  EXPECT_THAT(complaint_of("{name: rgbd0, color: " + camera + "}"),
              HasSubstr("cameras[0].name: there are two"));
  EXPECT_THAT(complaint_of("{name: left, depth: " + camera + "}"), HasSubstr("cameras[0]"));
}

TEST(Rig, MayBeUsedWithoutItsDepth) {
  const Rig rig = read(rig_with("rgbd:\n", "rgbd:\n"));
  const Rig without = without_depth(rig);
  ASSERT_EQ(without.rgbd.size(), 1U);
  EXPECT_FALSE(without.rgbd[0].measures_depth);
  EXPECT_EQ(without.rgbd[0].color, rig.rgbd[0].color);
  // Poses that are given of the depth sensor still hold.
  EXPECT_EQ(without.rgbd[0].depth_from_posed.translation, Eigen::Vector3d(0.05, 0, 0));
}

TEST(Rig, RotationsAreMadeExact) {
  const Rig rig =
      read(rig_with("[1, 0, 0, 0, 1, 0, 0, 0, 1]", "[1.0004, 0, 0, 0, 0, 1, 0, -1, 0]"));
  Eigen::Matrix3d expected;
  expected << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  EXPECT_LT((rig.rgbd[0].color_from_depth.rotation - expected).norm(), 1e-12);
}

TEST(Rig, MatricesThatAreNoRotationAreErrors) {
  const std::string identity = "[1, 0, 0, 0, 1, 0, 0, 0, 1]";
  const std::string place = "rig.yaml:8: rgbd[0].color_from_depth.rotation: expected a rotation";
  EXPECT_THAT(complaint(identity, "[1, 0, 0, 1, 0, 0, 0, 0, 1]"), HasSubstr(place));
  EXPECT_THAT(complaint(identity, "[0, 0, 0, 0, 0, 0, 0, 0, 0]"), HasSubstr(place));
  EXPECT_THAT(complaint(identity, "[1.01, 0, 0, 0, 1, 0, 0, 0, 1]"), HasSubstr(place));
  EXPECT_THAT(complaint(identity, "[1e200, 0, 0, 0, 1, 0, 0, 0, 1]"), HasSubstr(place));
  EXPECT_THAT(complaint(identity, "[1, 0, 0, 0, 1, 0, 0, 0, -1]"), HasSubstr("a reflection"));
  EXPECT_THAT(complaint(identity, "[1, 0, 0, 0, nan, 0, 0, 0, 1]"),
              HasSubstr("rig.yaml:8: rgbd[0].color_from_depth.rotation[4]: expected a number"));
}

TEST(Rig, EachWrongValueIsNamed) {
  const struct {
    const char* text;
    const char* replacement;
    const char* message;
  } cases[] = {
      {"width: 640", "width: 0",
       "rig.yaml:1: color.width: expected a whole number from 8 to 16384"},
      {"height: 480", "height: 16385", "rig.yaml:1: color.height: "},
      {"height: 480, ", "", "rig.yaml:1: color: missing key 'height'"},
      {"width: 640", "wdith: 640", "rig.yaml:1: color.wdith: unknown key, expected one of width, "},
      {"[500,", "[0,", "rig.yaml:1: color.camera_matrix[0]: expected a focal length"},
      {"501,", "-501,", "rig.yaml:1: color.camera_matrix[1]: expected a focal length"},
      {"320, 240]", "1281, 240]", "color.camera_matrix[2]: expected a principal point"},
      {"320, 240]", "320, -481]", "color.camera_matrix[3]: expected a principal point"},
      {"320, 240]", "320]", "color.camera_matrix: expected a list of 4 numbers, got 3"},
      {"[0.1, 0,", "[inf, 0,", "rig.yaml:1: color.distortion[0]: expected a number, got 'inf'"},
      {"0.001", "0", "rig.yaml:6: rgbd[0].depth_unit_m: expected a number above 0"},
      {"0.001", "1000", "rig.yaml:6: rgbd[0].depth_unit_m: expected at most 1 metre"},
      {"[0.05,", "[5000,", "rgbd[0].color_from_depth.translation: expected metres"},
      {"name: rgbd0", "name: a/b", "rig.yaml:3: rgbd[0].name: expected a name that a folder can"},
      {"name: rgbd0", "name: ..", "rig.yaml:3: rgbd[0].name: "},
      {"name: rgbd0", "name: ''", "rig.yaml:3: rgbd[0].name: "},
      {"name: rgbd0", R"(name: "a\nb")", "rig.yaml:3: rgbd[0].name: "},
      {"name: rgbd0", "name: color", "rgbd[0].name: expected another name than 'color'"},
      {"rgbd:\n", "others:\n", "rig.yaml:2: others: unknown key"},
      {"rgbd:\n", "pose: {source: []}\nrgbd:\n", "pose.source: expected a text, got a list"},
      {"rgbd:\n", "poses: {}\nrgbd:\n", "rig.yaml:2: poses: unknown key"},
  };
  for (const auto& [text, replacement, message] : cases) {
    EXPECT_THAT(complaint(text, replacement), HasSubstr(message));
  }
}

TEST(Rig, ReadsLensesOfAllModels) {
  const std::string usual = "distortion: [0.1, 0, 0, 0, 0]";
  EXPECT_EQ(read(rig_with("", "")).color.lens_model, LensModel::plumb_bob);
  for (const auto& [name, model] : {std::pair{"plumb_bob", LensModel::plumb_bob},
                                    {"rational", LensModel::rational},
                                    {"rational_polynomial", LensModel::rational},
                                    {"fisheye", LensModel::fisheye},
                                    {"equidistant", LensModel::fisheye}}) {
    std::string numbers = "0.1, 0.2";
    for (std::size_t i = 2; i < coefficient_count(model); ++i) numbers += ", 0.001";
    const Rig rig = read(rig_with(
        usual, std::string("distortion_model: ") + name + ", distortion: [" + numbers + "]"));
    EXPECT_EQ(rig.color.lens_model, model);
    EXPECT_EQ(rig.color.distortion[1], 0.2);
    EXPECT_EQ(rig.color.distortion[coefficient_count(model) - 1], 0.001);
    EXPECT_EQ(rig.rgbd[0].color.lens_model, LensModel::plumb_bob);
  }
}

TEST(Rig, WrongLensesAreNamed) {
  const std::string usual = "distortion: [0.1, 0, 0, 0, 0]";
  const auto lens = [&](const std::string& replacement) { return complaint(usual, replacement); };
  EXPECT_THAT(lens("distortion_model: fov, distortion: [1]"),
              HasSubstr("rig.yaml:1: color.distortion_model: expected plumb_bob, rational or "
                        "fisheye, got 'fov'"));
  EXPECT_THAT(lens("distortion_model: [], distortion: [1]"), HasSubstr("color.distortion_model: "));
  EXPECT_THAT(lens("distortion: [0, 0, 0, 0]"),
              HasSubstr("rig.yaml:1: color.distortion: expected the 5 numbers of a plumb_bob lens, "
                        "got 4"));
  EXPECT_THAT(lens("distortion_model: rational, distortion: [0, 0, 0, 0, 0]"),
              HasSubstr("expected the 8 numbers of a rational lens, got 5"));
  EXPECT_THAT(lens("distortion_model: fisheye, distortion: [0, 0, nan, 0]"),
              HasSubstr("rig.yaml:1: color.distortion[2]: expected a number, got 'nan'"));
  EXPECT_THAT(lens("distortion_model: fisheye, distortion: 3"), HasSubstr("color.distortion: "));
  // Corners 400 pixels off the axis: at 0.8 rad by 500 pixels of focal length, at 90 degrees by
  // 255.
  const std::string fisheye = "distortion_model: fisheye, distortion: [0, 0, 0, 0]";
  EXPECT_NO_THROW(read(rig_with(usual, fisheye)));
  EXPECT_THAT(complaint("[500, 501, 320, 240], " + usual, "[255, 255, 320, 240], " + fisheye),
              HasSubstr("rig.yaml:1: color.distortion: expected a fisheye lens whose picture, "
                        "corners included, ends less than 85 degrees off the axis"));
  // Folds back at 0.58 rad.
  EXPECT_THAT(lens("distortion_model: fisheye, distortion: [-1, 0, 0, 0]"),
              HasSubstr("color.distortion: expected a fisheye lens"));
}

TEST(Rig, NamesAreUnique) {
  std::ifstream file(testing::recordings_dir() + "/workbench/rig.yaml");
  std::stringstream text;
  text << file.rdbuf();
  std::string yaml = text.str();
  yaml.replace(yaml.find("rgbd1"), 5, "rgbd0");
  EXPECT_THAT(error_of([&] { read(yaml); }), HasSubstr("rgbd[1].name: there are two RGB-D"));
}

TEST(Rig, KeepsThePoseSettingsForTheirReader) {
  const Rig rig = read(rig_with("rgbd:\n", "pose: {source: file, files: {color: a.txt}}\nrgbd:\n"));
  EXPECT_EQ(rig.pose_source, "file");
  EXPECT_EQ(rig.pose.at("files").at("color").text(), "a.txt");
}

}  // namespace
}  // namespace diminish
