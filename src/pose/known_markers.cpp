#include "pose/known_markers.h"

#include <algorithm>

namespace diminish {

const Marker* find_marker(const std::vector<Marker>& markers, int id) {
  const auto found = std::find_if(markers.begin(), markers.end(),
                                  [id](const Marker& marker) { return marker.id == id; });
  return found == markers.end() ? nullptr : &*found;
}

std::map<int, double> known_marker_sizes(const Scene& scene) {
  std::map<int, double> sizes;
  if (scene.world_marker.size_m > 0) sizes[scene.world_marker.id] = scene.world_marker.size_m;
  for (const OccluderSpec& occluder : scene.occluders) {
    if (!occluder.settings) continue;
    if (const auto marker = occluder.settings->marker_on_it()) sizes[marker->id] = marker->size_m;
  }
  return sizes;
}

}  // namespace diminish
