#include "diminish/scene.h"

#include "diminish/occluder_detector.h"
#include "diminish/occluder_settings.h"
#include "expect_error.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

Scene scene_of(const std::string& yaml) {
  return read_scene(Config::parse(yaml, "scene.yaml"));
}

TEST(Scene, ReadsTheBundledScenes) {
  const Scene scene = load_scene(testing::recordings_dir() + "/workbench/scene.yaml");
  EXPECT_EQ(scene.marker_dictionary, "DICT_4X4_50");
  EXPECT_EQ(scene.world_marker.id, 0);
  EXPECT_EQ(scene.world_marker.size_m, 0.2);
  ASSERT_EQ(scene.occluders.size(), 1U);
  EXPECT_EQ(scene.occluders[0].name, "lamp");
  EXPECT_EQ(scene.occluders[0].detector, "marker");
  const auto& settings = settings_of<MarkerSettings>(scene.occluders[0]);
  EXPECT_EQ(settings.marker.id, 2);
  EXPECT_EQ(settings.mesh, testing::recordings_dir() + "/workbench/lamp.obj");
}

TEST(Scene, MarkersMayBeLeftOut) {
  const Scene scene = scene_of("occluders: [{name: a, detector: mask, color: a}]\n");
  EXPECT_EQ(scene.marker_dictionary, "DICT_4X4_50");
  EXPECT_EQ(scene.world_marker.size_m, 0);
}

TEST(Scene, EachWrongValueIsNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"occluders: []\n", "scene.yaml:1: occluders: expected at least one occluder"},
      {"world_marker: {id: 0, size_m: 1}\n", "scene.yaml:1: missing key 'occluders'"},
      {"occluders: [{detector: a}]\n", "scene.yaml:1: occluders[0]: missing key 'name'"},
      {"occluders:\n  - name: a\n", "scene.yaml:2: occluders[0]: missing key 'detector'"},
      {"occluders: [{name: '', detector: mask, color: a}]\n",
       "occluders[0].name: expected a name, got ''"},
      {"occluders: [{name: a, detector: }]\n", "occluders[0].detector: expected a text"},
      {"occluders:\n- {name: a, detector: mask, color: a}\n- {name: a, detector: mask, color: a}\n",
       "scene.yaml:3: occluders[1].name: there are two occluders called 'a'"},
      {"occluders: {name: a}\n", "scene.yaml:1: occluders: expected a list, got a map"},
      {"world_marker: {id: -1, size_m: 1}\noccluders: []\n", "world_marker.id: expected a whole"},
      {"world_marker: {id: 1, size_m: 0}\noccluders: []\n", "world_marker.size_m: expected a num"},
      {"world_marker: {id: 1}\noccluders: []\n", "world_marker: missing key 'size_m'"},
      {"world_marker: {id: 1, size: 1}\noccluders: []\n", "world_marker.size: unknown key"},
      {"marker_dictionary: [4]\noccluders: []\n", "marker_dictionary: expected a text"},
      {"occluders: [{name: a, detector: nose}]\n",
       "scene.yaml:1: occluders[0].detector: expected one of articulated, box, "},
      {"occluders: [{name: a, detector: mask}]\n", "occluders[0]: missing key 'color'"},
      {"occluder: []\n", "scene.yaml:1: occluder: unknown key, expected one of"},
  };
  for (const auto& [yaml, message] : cases) {
    EXPECT_THAT(error_of([&yaml = yaml] { scene_of(yaml); }), HasSubstr(message));
  }
}

}  // namespace
}  // namespace diminish
