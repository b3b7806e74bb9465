#include "blend/layers.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "blend/confidence_grid.h"

namespace diminish {
namespace {

/// One camera's view of a pixel.
struct Surface {
  float z_m, noise_m;
};

/// A pixel of the region in all layers.
class PixelSurfaces {
 public:
  PixelSurfaces(const std::vector<BlendedLayer>& layers, const Intrinsics& color, float agreement_m)
      : layers_(layers), color_(color), agreement_m_(agreement_m), surfaces_(layers.size()) {}

  void look_at(int x, int y) {
    const Eigen::Vector3f ray = pinhole_ray(color_, static_cast<float>(x), static_cast<float>(y));
    constexpr DepthNoise noise;
    nearest_ = nullptr;
    for (std::size_t k = 0; k < layers_.size(); ++k) {
      const float z = layers_[k].layer->depth_m(x, y);
      surfaces_[k] = {z, z > 0 ? noise.at(layers_[k].place.depth_m(ray * z)) : 0.F};
      if (z > 0 && (!nearest_ || z < nearest_->z_m)) nearest_ = &surfaces_[k];
    }
  }
  bool any() const { return nearest_ != nullptr; }
  /// How much neighbouring pixels of the same surface may differ.
  float own_tolerance_m(std::size_t k) const {
    return agreement_tolerance_m(agreement_m_, surfaces_[k].noise_m, surfaces_[k].noise_m);
  }
  bool sees_nearest(std::size_t k) const {
    const Surface& own = surfaces_[k];
    return own.z_m > 0 && own.z_m - nearest_->z_m <=
                              agreement_tolerance_m(agreement_m_, own.noise_m, nearest_->noise_m);
  }
  /// The camera if only one sees the nearest surface and another looks past it; else none.
  std::optional<std::size_t> lone() const {
    std::optional<std::size_t> one;
    std::size_t there = 0;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      if (!(surfaces_[k].z_m > 0)) continue;
      ++there;
      if (!sees_nearest(k)) continue;
      if (one) return std::nullopt;
      one = k;
    }
    return there > 1 ? one : std::nullopt;
  }

 private:
  const std::vector<BlendedLayer>& layers_;
  const Intrinsics& color_;
  float agreement_m_;
  std::vector<Surface> surfaces_;
  const Surface* nearest_ = nullptr;
};

template <class Visit>
void for_each_pixel(const Rect& part, const Visit& visit) {
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) visit(x, y);
  }
}

bool is_sliver(const Layer& layer, const Rect& region, int x, int y, float tolerance_m) {
  constexpr int side = 2 * blending::window_reach + 1;
  const Rect window =
      intersect({x - blending::window_reach, y - blending::window_reach, side, side}, region);
  int same = 0;
  for_each_pixel(window, [&](int u, int v) {
    const float z = layer.depth_m(u, v);
    same += z > 0 && std::abs(z - layer.depth_m(x, y)) < tolerance_m ? 1 : 0;
  });
  return static_cast<float>(same) <
         blending::least_part * static_cast<float>(window.width * window.height);
}

void remove_slivers(const std::vector<BlendedLayer>& layers, const Rect& region,
                    PixelSurfaces& pixel) {
  struct Sliver {
    Layer* layer;
    int x, y;
  };
  std::vector<Sliver> slivers;
  for_each_pixel(region, [&](int x, int y) {
    pixel.look_at(x, y);
    const std::optional<std::size_t> lone = pixel.any() ? pixel.lone() : std::nullopt;
    if (!lone) return;
    Layer& layer = *layers[*lone].layer;
    if (is_sliver(layer, region, x, y, pixel.own_tolerance_m(*lone)))
      slivers.push_back({&layer, x, y});
  });
  for (const Sliver& sliver : slivers) sliver.layer->depth_m(sliver.x, sliver.y) = 0;
}

/// Pixels of the RGB-D camera's colour image per pixel of the picture, over a part of the picture.
float resolution(const Layer& layer, const Rect& part) {
  const int right = part.right() - 1;
  const int bottom = part.bottom() - 1;
  const Eigen::Vector2f origin = layer.texture(part.x, part.y);
  const Eigen::Vector2f along_x = layer.texture(right, part.y) - origin;
  const Eigen::Vector2f along_y = layer.texture(part.x, bottom) - origin;
  const float area = along_x.x() * along_y.y() - along_x.y() * along_y.x();
  const int pixels = std::max(1, right - part.x) * std::max(1, bottom - part.y);
  return std::max(area / static_cast<float>(pixels), ConfidenceGrid::least_resolution);
}

void trust(const std::vector<BlendedLayer>& layers, const Rect& region, PixelSurfaces& pixel,
           ConfidenceGrid& grid) {
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      Rect cell = grid.cell(column, row);
      cell.x += region.x;
      cell.y += region.y;
      for (std::size_t k = 0; k < layers.size(); ++k) {
        bool covered = true;
        for_each_pixel(cell, [&](int x, int y) {
          pixel.look_at(x, y);
          covered = covered && pixel.any() && pixel.sees_nearest(k);
        });
        const Layer& layer = *layers[k].layer;
        grid.set(k, column, row, covered ? resolution(layer, cell) : 0,
                 layer.depth_m(cell.x, cell.y));
      }
    }
  }
  for (std::size_t k = 0; k < layers.size(); ++k) grid.finish(k, layers[k].place);
}

}  // namespace

std::size_t count_drawn(const Layer& layer, const Rect& region) {
  std::size_t count = 0;
  for (int y = region.y; y < region.bottom(); ++y) {
    const float* depth = layer.depth_m.row(y);
    count += static_cast<std::size_t>(
        std::count_if(depth + region.x, depth + region.right(), [](float z) { return z > 0; }));
  }
  return count;
}

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

void blend_layers(const std::vector<BlendedLayer>& layers, const Intrinsics& color,
                  float agreement_m, Reconstruction& reconstruction) {
  const Rect& region = reconstruction.region;
  PixelSurfaces pixel(layers, color, agreement_m);
  remove_slivers(layers, region, pixel);
  ConfidenceGrid grid;
  grid.begin(region, color, layers.size());
  trust(layers, region, pixel, grid);

  struct Trusted {
    float confidence = 0;
    const BlendedLayer* layer = nullptr;
  };
  std::vector<float> nodes;
  Image<float> confidences(region.width, static_cast<int>(layers.size()));
  for (int y = region.y; y < region.bottom(); ++y) {
    for (std::size_t k = 0; k < layers.size(); ++k) {
      grid.row(k, y - region.y, nodes, confidences.row(static_cast<int>(k)));
    }
    for (int x = region.x; x < region.right(); ++x) {
      SecondView& second = reconstruction.second;
      second.color(x, y) = {};
      second.source(x, y) = second.share(x, y) = 0;
      pixel.look_at(x, y);
      if (!pixel.any()) continue;
      std::vector<Trusted> order;
      for (std::size_t k = 0; k < layers.size(); ++k) {
        if (!pixel.sees_nearest(k)) continue;
        order.push_back(
            {confidences(x - region.x, static_cast<int>(k)) + blending::least_confidence,
             &layers[k]});
      }
      std::stable_sort(order.begin(), order.end(), [](const Trusted& a, const Trusted& b) {
        return a.confidence > b.confidence;
      });
      order.resize(std::max<std::size_t>(order.size(), 3));
      const BlendedLayer& first = *order[0].layer;
      reconstruction.color(x, y) = first.layer->color(x, y);
      reconstruction.depth_m(x, y) = first.layer->depth_m(x, y);
      reconstruction.source(x, y) = first.source;
      const float of_first = order[0].confidence - order[2].confidence;
      const float of_second = order[1].confidence - order[2].confidence;
      if (!(of_second > 0)) continue;
      const auto share =
          static_cast<std::uint8_t>(std::lrint(255 * of_second / (of_first + of_second)));
      if (share == 0) continue;
      second.color(x, y) = order[1].layer->layer->color(x, y);
      second.source(x, y) = order[1].layer->source;
      second.share(x, y) = share;
    }
  }
}

}  // namespace diminish
