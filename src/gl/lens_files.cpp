#include "gl/lens_files.h"

#include <set>

namespace diminish::gl {

std::vector<std::string> lens_files(const Rig& rig) {
  std::set<LensModel> models = {rig.color.lens_model};
  for (const RgbdCamera& camera : rig.rgbd) models.insert(camera.color.lens_model);
  std::vector<std::string> files;
  if (models.count(LensModel::rational) != 0) files.emplace_back("lens_rational.glsl");
  if (models.count(LensModel::fisheye) != 0) files.emplace_back("lens_fisheye.glsl");
  files.emplace_back("lens.glsl");
  return files;
}

std::vector<std::string> vertex_files(const Rig& rig, const char* last) {
  std::vector<std::string> files = lens_files(rig);
  files.insert(files.begin(), {"frame.glsl", "sdct.glsl"});
  files.insert(files.end(), {"rule1.glsl", last});
  return files;
}

}  // namespace diminish::gl
