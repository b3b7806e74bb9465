#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/yaml_tree.h"
#include "diminish/error.h"
#include "setup/calibrate/yaml_edit.h"

/// Any rig.yaml gets a calibration's values, or is refused: then they are there, and can be
/// replaced.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  const std::vector<std::vector<YamlStep>> places = {
      {key("color")},
      {key("rgbd"), named_item("rgbd0"), key("depth")},
      {key("pose"), key("source")},
  };
  std::string yaml(reinterpret_cast<const char*>(data), size);
  for (const auto& place : places) {
    try {
      yaml = set_yaml(yaml, place, "{width: 8, list: [1, 2]}", "rig.yaml");
    } catch (const Error&) {
      return 0;
    }
    if (!yaml_has(yaml, place, "rig.yaml")) std::abort();
  }
  // What is there is not written twice.
  try {
    std::string again = yaml;
    for (const auto& place : places) {
      again = set_yaml(again, place, "{width: 8, list: [1, 2]}", "rig.yaml");
    }
    if (again != yaml) std::abort();
  } catch (const Error&) {
    std::abort();
  }
  return 0;
}
