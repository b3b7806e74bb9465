#include "diminish/validate.h"

#include <functional>
#include <limits>

#include "diminish/occluder_settings.h"
#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

const std::string rig_yaml =
    "color: {width: 640, height: 480, camera_matrix: [500, 501, 320, 240],"
    " distortion: [0.1, 0, 0, 0, 0]}\n"
    "rgbd:\n"
    "- name: rgbd0\n"
    "  color: {width: 320, height: 240, camera_matrix: [250, 250, 160, 120],"
    " distortion: [0, 0, 0, 0, 0]}\n"
    "  depth: {width: 512, height: 424, camera_matrix: [365, 365, 255, 206],"
    " distortion: [0, 0, 0, 0, 0]}\n"
    "  depth_unit_m: 0.001\n"
    "  color_from_depth: {rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1], translation: [0.05, 0, 0]}\n";
const std::string scene_yaml =
    "world_marker: {id: 0, size_m: 0.2}\n"
    "occluders:\n"
    "- {name: cup, detector: marker, marker: {id: 5, size_m: 0.1},"
    " vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}\n"
    "- {name: zone, detector: box, frame: rgbd0, min: [0, 0, 0], max: [1, 1, 1]}\n"
    "- {name: hand, detector: mask, color: masks, rgbd0: more}\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// The same mistake in a file, and in a program's structure.
template <class Thing>
struct Mistake {
  const char* from;
  const char* to;
  std::function<void(Thing&)> make;
};

/// What a program is told must be what is said of the file, after file and line.
void expect_same(const std::string& of_file, const std::string& of_program) {
  ASSERT_FALSE(of_program.empty());
  const std::size_t end_of_line_number = of_file.find(": ");
  ASSERT_NE(end_of_line_number, std::string::npos) << of_file;
  EXPECT_EQ(of_file.substr(end_of_line_number + 2), of_program);
}

TEST(Validate, SaysOfAProgramsRigWhatIsSaidOfAFile) {
  const Mistake<Rig> mistakes[] = {
      {"width: 640", "width: 7", [](Rig& rig) { rig.color.width = 7; }},
      {"height: 424", "height: 16385", [](Rig& rig) { rig.rgbd[0].depth.height = 16385; }},
      {"[500,", "[0,", [](Rig& rig) { rig.color.fx = 0; }},
      {"501,", "-501,", [](Rig& rig) { rig.color.fy = -501; }},
      {"320, 240]", "1281, 240]", [](Rig& rig) { rig.color.cx = 1281; }},
      {"160, 120]", "160, -241]", [](Rig& rig) { rig.rgbd[0].color.cy = -241; }},
      {"0.001", "0", [](Rig& rig) { rig.rgbd[0].depth_unit_m = 0; }},
      {"0.001", "1000", [](Rig& rig) { rig.rgbd[0].depth_unit_m = 1000; }},
      {"[0.05,", "[5000,", [](Rig& rig) { rig.rgbd[0].color_from_depth.translation.x() = 5000; }},
      {"[1, 0, 0, 0, 1, 0, 0, 0, 1]", "[1, 0, 0, 0, 1, 0, 0, 0, 2]",
       [](Rig& rig) { rig.rgbd[0].color_from_depth.rotation(2, 2) = 2; }},
      {"[1, 0, 0, 0, 1, 0, 0, 0, 1]", "[1, 0, 0, 0, 1, 0, 0, 0, -1]",
       [](Rig& rig) { rig.rgbd[0].color_from_depth.rotation(2, 2) = -1; }},
      {"name: rgbd0", "name: a/b", [](Rig& rig) { rig.rgbd[0].name = "a/b"; }},
      {"name: rgbd0", "name: color", [](Rig& rig) { rig.rgbd[0].name = "color"; }},
      {"rgbd:\n", "pose: {source: sextant}\nrgbd:\n",
       [](Rig& rig) { rig.pose_source = "sextant"; }},
  };
  const Rig good = read_rig(Config::parse(rig_yaml, "rig.yaml"));
  EXPECT_NO_THROW(validate(good));
  for (const auto& [from, to, make] : mistakes) {
    SCOPED_TRACE(to);
    Rig rig = good;
    make(rig);
    expect_same(error_of([&from = from, &to = to] {
                  read_rig(Config::parse(replaced(rig_yaml, from, to), "rig.yaml"));
                }),
                error_of([&] { validate(rig); }));
  }
}

TEST(Validate, SeesInARigWhatNoFileCanHold) {
  Rig rig = read_rig(Config::parse(rig_yaml, "rig.yaml"));
  rig.color.distortion[1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error_of([&] { validate(rig); }), "color.distortion[1]: expected a number, got 'inf'");
  rig.color.distortion[1] = 0;
  rig.rgbd[0].color_from_depth.rotation(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { validate(rig); }), HasSubstr("rgbd[0].color_from_depth.rotation: "));
  rig.rgbd.clear();
  EXPECT_NO_THROW(validate(rig)) << "the memory may do without RGB-D cameras";
}

/// The settings of an occluder, to change them.
template <class Settings>
Settings& change(Scene& scene, std::size_t index) {
  auto copy = std::make_shared<Settings>(
      dynamic_cast<const Settings&>(*scene.occluders.at(index).settings));
  scene.occluders[index].settings = copy;
  return *copy;
}

TEST(Validate, SaysOfAProgramsSceneWhatIsSaidOfAFile) {
  const Mistake<Scene> mistakes[] = {
      {"size_m: 0.2", "size_m: -0.2", [](Scene& scene) { scene.world_marker.size_m = -0.2; }},
      {"{id: 5", "{id: 70000",
       [](Scene& scene) { change<MarkerSettings>(scene, 0).marker.id = 70000; }},
      {"size_m: 0.1", "size_m: 0",
       [](Scene& scene) { change<MarkerSettings>(scene, 0).marker.size_m = 0; }},
      {", [0, 0, 1]]", "]",
       [](Scene& scene) { change<MarkerSettings>(scene, 0).vertices.pop_back(); }},
      {"[0, 1, 0], [0, 0, 1]", "[2, 0, 0], [3, 0, 0]",
       [](Scene& scene) {
         change<MarkerSettings>(scene, 0).vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
       }},
      {"[0, 1, 0], [0, 0, 1]", "[0, 1, 0], [0, 0, 1e308]",
       [](Scene& scene) { change<MarkerSettings>(scene, 0).vertices[3].z() = 1e308; }},
      {" vertices", " mesh: a.obj, vertices",
       [](Scene& scene) { change<MarkerSettings>(scene, 0).mesh = "a.obj"; }},
      {"max: [1", "max: [-1", [](Scene& scene) { change<BoxSettings>(scene, 1).max_m.x() = -1; }},
      {"frame: rgbd0", "frame: rgbd7",
       [](Scene& scene) { change<BoxSettings>(scene, 1).frame = "rgbd7"; }},
      {", rgbd0: more", ", rgbd0: more, rgbd3: x",
       [](Scene& scene) { change<MaskSettings>(scene, 2).rgbd["rgbd3"] = "x"; }},
      {"name: hand", "name: cup", [](Scene& scene) { scene.occluders[2].name = "cup"; }},
      {"detector: box", "detector: nose",
       [](Scene& scene) { scene.occluders[1].detector = "nose"; }},
  };
  const Rig rig = read_rig(Config::parse(rig_yaml, "rig.yaml"));
  Scene good = read_scene(Config::parse(scene_yaml, "scene.yaml"));
  for (OccluderSpec& spec : good.occluders) spec.place = {};  // as a program's
  EXPECT_NO_THROW(validate(good, rig));
  for (const auto& [from, to, make] : mistakes) {
    SCOPED_TRACE(to);
    Scene scene = good;
    make(scene);
    expect_same(error_of([&, &from = from, &to = to] {
                  validate(read_scene(Config::parse(replaced(scene_yaml, from, to), "scene.yaml")),
                           rig);
                }),
                error_of([&] { validate(scene, rig); }));
  }
}

TEST(Validate, ASceneNeedsObjectsWithTheirDetectorsSettings) {
  Scene scene;
  EXPECT_EQ(error_of([&] { validate(scene); }), "occluders: expected at least one occluder");
  scene.occluders = {{"cup", "marker", nullptr}};
  EXPECT_EQ(error_of([&] { validate(scene); }),
            "occluders[0]: expected the settings of the detector marker");
}

}  // namespace
}  // namespace diminish
