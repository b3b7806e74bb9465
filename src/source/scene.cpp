#include "diminish/scene.h"

#include <algorithm>

namespace diminish {
namespace {

constexpr int max_marker_id = 65535;

std::string read_name(const Config& config) {
  std::string name = config.text();
  if (name.empty()) config.fail("expected a name, got ''");
  return name;
}

}  // namespace

MarkerSpec read_marker(const Config& config) {
  config.expect_keys({"id", "size_m"});
  return {config.at("id").integer(0, max_marker_id), config.at("size_m").positive_number()};
}

Scene load_scene(const std::filesystem::path& file) {
  return read_scene(Config::load(file));
}

Scene read_scene(const Config& config) {
  config.expect_keys({"marker_dictionary", "world_marker", "occluders"});
  Scene scene;
  const Config dictionary = config.find("marker_dictionary");
  if (dictionary.exists()) scene.marker_dictionary = dictionary.text();
  const Config world_marker = config.find("world_marker");
  if (world_marker.exists()) scene.world_marker = read_marker(world_marker);
  const Config occluders = config.at("occluders");
  for (const Config& item : occluders.items()) {
    OccluderSpec occluder{read_name(item.at("name")), read_name(item.at("detector")), item};
    const auto same = [&](const OccluderSpec& other) { return other.name == occluder.name; };
    if (std::any_of(scene.occluders.begin(), scene.occluders.end(), same)) {
      item.at("name").fail("there are two occluders called '" + occluder.name + "'");
    }
    scene.occluders.push_back(std::move(occluder));
  }
  if (scene.occluders.empty()) occluders.fail("expected at least one occluder");
  return scene;
}

}  // namespace diminish
