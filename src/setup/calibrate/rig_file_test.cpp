#include "setup/calibrate/rig_file.h"

#include "core/text.h"
#include "diminish/rig.h"
#include "expect_error.h"
#include "paths.h"
#include "setup/calibrate/yaml_edit.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

const Intrinsics camera{640, 480, 512.3456, 510.5, 320.25, 239.5, {-0.125, 0.0625, 0, 0.001, 0}};
constexpr const char* camera_yaml =
    "{width: 640, height: 480, camera_matrix: [512.346, 510.500, 320.250, 239.500], distortion: "
    "[-0.125, 0.0625, 0, 0.001, 0]}";

RigidTransform some_transform() {
  RigidTransform transform;
  transform.rotation =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  transform.translation = {0.1, -0.2, 0.3};
  return transform;
}

class RigFileTest : public ::testing::Test {
 protected:
  RigFile open(const std::string& text) { return RigFile(folder.write("rig.yaml", text)); }
  Rig load() { return load_rig(folder.path() / "rig.yaml"); }

  TemporaryFolder folder;
};

// From nothing to a rig that can be loaded, as someone sets one up.
TEST_F(RigFileTest, IsFilledStepByStep) {
  const auto file = folder.path() / "rig.yaml";
  for (const char* name : {"color", "rgbd0_color", "rgbd1_color", "rgbd1_depth", "rgbd0_depth"}) {
    RigFile rig(file);
    rig.set_intrinsics(name, camera);
    rig.write();
  }
  for (const char* name : {"rgbd0", "rgbd1"}) {
    RigFile rig(file);
    rig.set_color_from_depth(name, some_transform());
    rig.write();
  }
  EXPECT_THAT(error_of([&] { load(); }), HasSubstr("depth_unit_m"));
  std::string text =
      set_yaml(read_text_file(file, 1 << 20),
               {key("rgbd"), named_item("rgbd0"), key("depth_unit_m")}, "0.001", file);
  text = set_yaml(text, {key("rgbd"), named_item("rgbd1"), key("depth_unit_m")}, "0.0002", file);
  folder.write("rig.yaml", text);
  const Rig rig = load();
  ASSERT_EQ(rig.rgbd.size(), 2U);
  EXPECT_EQ(rig.rgbd[0].name, "rgbd0");
  EXPECT_EQ(rig.rgbd[1].depth_unit_m, 0.0002);
  EXPECT_NEAR(rig.rgbd[1].depth.fx, camera.fx, 1e-3);
  EXPECT_EQ(rig.rgbd[0].depth.distortion, camera.distortion);
  EXPECT_LT((rig.rgbd[1].color_from_depth.rotation - some_transform().rotation).norm(), 1e-7);
}

TEST_F(RigFileTest, WritesWhatIsReadOfEveryLens) {
  for (const LensModel model : {LensModel::plumb_bob, LensModel::rational, LensModel::fisheye}) {
    Intrinsics sensor = camera;
    sensor.lens_model = model;
    sensor.distortion = {};
    for (std::size_t i = 0; i < coefficient_count(model); ++i) {
      sensor.distortion[i] = 0.01 * static_cast<double>(i + 1);
    }
    RigFile rig = open(read_text_file(
        std::filesystem::path(testing::recordings_dir()) / "workbench" / "rig.yaml", 1 << 20));
    rig.set_intrinsics("rgbd0_color", sensor);
    rig.write();
    EXPECT_EQ(load().rgbd[0].color.lens_model, model);
    EXPECT_EQ(load().rgbd[0].color.distortion, sensor.distortion);
  }
}

TEST_F(RigFileTest, LeavesEverythingElseAsItIs) {
  const std::string text = read_text_file(
      std::filesystem::path(testing::recordings_dir()) / "workbench" / "rig.yaml", 1 << 20);
  RigFile rig = open(text);
  rig.set_intrinsics("color", camera);
  rig.set_intrinsics("rgbd1_depth", camera);
  rig.set_color_from_depth("rgbd0", some_transform());
  // What is expected is made with plain replacements.
  std::string expected = text;
  const auto replace = [&](const std::string& from, const std::string& to, std::size_t after) {
    const std::size_t at = expected.find(from, after);
    ASSERT_NE(at, std::string::npos) << from;
    expected.replace(at, from.size(), to);
  };
  const std::size_t rgbd = expected.find("rgbd:");
  const std::string color =
      expected.substr(expected.find("color: {") + 7, rgbd - expected.find("color: {") - 8);
  replace(color, camera_yaml, 0);
  const std::size_t depth = expected.find("depth: {", expected.find("name: rgbd1")) + 7;
  replace(expected.substr(depth, expected.find('\n', depth) - depth), camera_yaml, depth);
  const std::string from =
      "color_from_depth:   # x_color = rotation * x_depth + translation, metres\n"
      "      rotation: [0.999980000, 0.001987981, 0.006003944, -0.002011981, 0.999990000, "
      "0.003993963, -0.005995944, -0.004005963, 0.999974000]\n"
      "      translation: [0.051991962, -0.000608612, -0.001309760]\n";
  replace(from,
          "color_from_depth: {rotation: [0.95853725, -0.152700217, 0.240621061, 0.163941342, "
          "0.986099268, -0.0272896634, -0.233108956, 0.0656060888, 0.970235073], "
          "translation: [0.1, -0.2, 0.3]}   # x_color = rotation * x_depth + translation, metres\n",
          0);
  const auto first_lines = [](const std::string& t) { return t.substr(0, t.find("color_from")); };
  EXPECT_EQ(first_lines(rig.text()), first_lines(expected));
  rig.write();
  const Rig loaded = load();
  EXPECT_LT((loaded.rgbd[0].color_from_depth.rotation - some_transform().rotation).norm(), 1e-7);
  EXPECT_NEAR(loaded.rgbd[1].color_from_depth.translation.x(), 0.051991962, 1e-12);
  EXPECT_EQ(loaded.rgbd[1].depth.width, 640);
  EXPECT_EQ(loaded.rgbd[0].depth.width, 512);
  EXPECT_THAT(rig.text(), HasSubstr("}   # x_color = rotation * x_depth + translation, metres\n"));
  EXPECT_EQ(rig.text().substr(0, text.find('\n')), text.substr(0, text.find('\n')));
}

TEST_F(RigFileTest, SetsFixedPosesWhateverTheSourceWas) {
  for (const char* pose : {"", "pose: {source: marker}\n",
                           "pose:\n  source: file\n  files: {color: a.txt, rgbd0: b.txt}\n"}) {
    RigFile rig = open(std::string("# mine\ncolor: {}\n") + pose + "# end\n");
    rig.set_fixed_poses({{"rgbd0", some_transform()}, {"rgbd1", RigidTransform{}}});
    const Config config = Config::parse(rig.text());
    EXPECT_EQ(config.at("pose").at("source").text(), "fixed");
    EXPECT_EQ(config.at("pose").keys().size(), 2U);
    const Config poses = config.at("pose").at("color_from_rgbd");
    EXPECT_NEAR(poses.at("rgbd0").at("translation").vector3().y(), -0.2, 1e-12);
    EXPECT_EQ(poses.at("rgbd1").at("rotation").numbers(9)[0], 1);
    EXPECT_THAT(rig.text(), HasSubstr("# mine\ncolor: {}\n"));
    EXPECT_THAT(rig.text(), HasSubstr("# end\n"));
  }
}

TEST(SetYaml, KeepsLayoutsOfAllKinds) {
  const auto set = [](const std::string& yaml, const std::string& value = "7") {
    return set_yaml(yaml, {key("a"), named_item("x"), key("b")}, value, "t.yaml");
  };
  EXPECT_EQ(set("a: [{name: x, b: 1}]\n"), "a: [{name: x, b: 7}]\n");
  EXPECT_EQ(set("a: [{name: x, b: \"q\", c: 2}] # keep\n"), "a: [{name: x, b: 7, c: 2}] # keep\n");
  EXPECT_EQ(set("a: [{name: y}]\n"), "a: [{name: y}, {name: x, b: 7}]\n");
  EXPECT_EQ(set("a: [{name: x,\n   b: [1,\n  2], c: 3}]\n", "[8]"),
            "a: [{name: x,\n   b: [8], c: 3}]\n");
  EXPECT_EQ(set("a:\n- name: x\n  c: 1\n- name: z\nq: 1\n"),
            "a:\n- name: x\n  c: 1\n  b: 7\n- name: z\nq: 1\n");
  EXPECT_EQ(set("a:\n  - name: y\n\n# last\n"),
            "a:\n  - name: y\n  - name: x\n    b: 7\n\n# last\n");
  EXPECT_EQ(set("q: 1\n"), "q: 1\na:\n  - name: x\n    b: 7\n");
  EXPECT_EQ(set("# only a comment\n"), "# only a comment\na:\n  - name: x\n    b: 7\n");
  EXPECT_EQ(set("a:\n  - name: x\n    b:   # why\n      c: 1\n      d: 2\n    e: 3\n"),
            "a:\n  - name: x\n    b: 7   # why\n    e: 3\n");
  EXPECT_EQ(set("q: 1"), "q: 1\na:\n  - name: x\n    b: 7\n");
}

// One anchor's text stands for both cameras: changing it would change the other.
TEST(SetYaml, RefusesWhatItCannotChangeAlone) {
  const std::string yaml = "color: &lens {width: 1}\nrgbd: [{name: x, color: *lens}]\n";
  const auto change = [&](const std::vector<YamlStep>& place) {
    return error_of([&] { set_yaml(yaml, place, "{width: 2}", "rig.yaml"); });
  };
  EXPECT_THAT(change({key("rgbd"), named_item("x"), key("color")}),
              ::testing::AllOf(HasSubstr("rig.yaml: rgbd.x.color"), HasSubstr("{width: 2}")));
  EXPECT_THAT(error_of([] {
                set_yaml("a: 1\n", {key("a"), key("b")}, "1", "rig.yaml");
              }),
              HasSubstr("rig.yaml: a.b"));
  EXPECT_THAT(error_of([] { set_yaml("a: {b\n", {key("c")}, "1", "rig.yaml"); }),
              HasSubstr("rig.yaml"));
}

TEST_F(RigFileTest, CameraNamesAreChecked) {
  RigFile rig = open("");
  EXPECT_THAT(error_of([&] { rig.set_intrinsics("rgbd0", camera); }), HasSubstr("rgbd0_color"));
  EXPECT_THAT(error_of([&] { rig.set_intrinsics("_color", camera); }), HasSubstr("'_color'"));
}

}  // namespace
}  // namespace diminish
