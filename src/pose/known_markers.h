#pragma once

#include <map>
#include <vector>

#include "diminish/poses.h"
#include "diminish/scene.h"

namespace diminish {

/// The marker with this id; nullptr if it was not seen.
const Marker* find_marker(const std::vector<Marker>& markers, int id);

/// The size in metres, by id, of every marker that the scene knows (the world marker and those of
/// objects).
std::map<int, double> known_marker_sizes(const Scene& scene);

}  // namespace diminish
