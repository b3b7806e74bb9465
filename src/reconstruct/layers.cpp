#include "reconstruct/layers.h"

#include <algorithm>

namespace diminish {
namespace {

std::size_t count_drawn(const Layer& layer, const Rect& region) {
  std::size_t count = 0;
  for (int y = region.y; y < region.bottom(); ++y) {
    const float* depth = layer.depth_m.row(y);
    count += static_cast<std::size_t>(
        std::count_if(depth + region.x, depth + region.right(), [](float z) { return z > 0; }));
  }
  return count;
}

}  // namespace

void merge_layers(const std::vector<const Layer*>& layers, float agreement_m,
                  Reconstruction& reconstruction) {
  const Rect& region = reconstruction.region;
  struct Candidate {
    std::size_t camera, drawn;
  };
  std::vector<Candidate> order;
  order.reserve(layers.size());
  for (std::size_t camera = 0; camera < layers.size(); ++camera) {
    if (layers[camera]) order.push_back({camera, count_drawn(*layers[camera], region)});
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Candidate& a, const Candidate& b) { return a.drawn > b.drawn; });

  for (const Candidate& candidate : order) {
    const Layer& layer = *layers[candidate.camera];
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) {
        const float z = layer.depth_m(x, y);
        float& nearest = reconstruction.depth_m(x, y);
        if (z > 0 && (nearest == 0 || z < nearest - agreement_m)) {
          nearest = z;
          reconstruction.color(x, y) = layer.color(x, y);
          reconstruction.source(x, y) = static_cast<std::uint8_t>(1 + candidate.camera);
        }
      }
    }
  }
}

}  // namespace diminish
