#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/occlusion_masks.h"
#include "diminish/scene_samples.h"

namespace diminish {

/// Whether what each RGB-D camera sees fits the colour camera's picture, where both see the same.
/// In tiles, the samples' brightness is correlated with the picture's at their places: neither
/// exposure nor white balance changes that, but a shift of a few pixels does. Samples behind others
/// are left out: an object that stays in the scene hides them.
class SceneFit {
 public:
  explicit SceneFit(const Intrinsics& color);

  /// by_camera: for each RGB-D camera the median correlation of the tiles with texture, -1 to 1;
  /// nothing if there are too few of them. A good set-up has .88 and more. occlusion: there is
  /// another thing in front. Cost: 30 ns a sample.
  void find(ImageView<Bgr> picture, const Mask& occlusion, const SceneSamples& scene,
            std::vector<std::optional<double>>& by_camera);

 private:
  /// Sums over the samples in a tile: of the picture's brightness, and of the samples'.
  struct Tile {
    double count = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  };
  using Tiles = std::vector<Tile>;
  struct Textured {
    double correlation, deviation;
  };
  using Samples = std::vector<SceneSample>::const_iterator;

  static constexpr std::size_t bands = 4;

  /// Of one RGB-D camera's samples.
  std::optional<double> correlate(ImageView<Bgr> picture, const Mask& occlusion, Samples begin,
                                  Samples end);
  void find_nearest(ImageView<Bgr> picture, const SceneSamples& scene);
  int cell_of(float pixel) const { return static_cast<int>(pixel) / cell_side_; }
  void add_up(ImageView<Bgr> picture, const Mask& occlusion, Samples begin, Samples end,
              Tiles& tiles) const;
  /// Of one tile, in all bands.
  void collect(std::size_t index);
  /// What the picture shows there; nothing outside it, or where an object is.
  std::optional<float> brightness_at(ImageView<Bgr> picture, const Mask& occlusion,
                                     const Eigen::Vector2f& pixel) const;

  int block_;      ///< over which the picture is averaged, pixels
  int tile_side_;  ///< pixels
  int columns_, rows_;
  int cell_side_;  ///< pixels
  /// Of all cameras' samples, by cell: what is far behind them is hidden from the colour camera.
  Image<float> nearest_m_;
  /// Of two grids, the second shifted by half a tile; for each band of samples.
  std::array<Tiles, bands> tiles_;
  std::vector<Textured> found_;
  std::vector<double> values_;
};

}  // namespace diminish
