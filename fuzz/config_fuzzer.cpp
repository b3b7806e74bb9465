#include <cstdint>
#include <string>

#include "detect/articulated/kinematic_chain.h"
#include "diminish/error.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

/// Any bytes are either a rig.yaml, a scene.yaml or the links of an arm, or an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace diminish;
  const std::string yaml(reinterpret_cast<const char*>(data), size);
  try {
    const Config config = Config::parse(yaml, "fuzz.yaml");
    try {
      read_rig(config);
    } catch (const Error&) {
    }
    try {
      KinematicChain::read(config);
    } catch (const Error&) {
    }
    read_scene(config);
  } catch (const Error&) {
  }
  return 0;
}
