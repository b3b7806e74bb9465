#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/scene_samples.h"
#include "scene/background_planes.h"

namespace diminish {

/// Where the colour camera's picture shows a plane and nothing else, in cells, and the plane's
/// grain there: what the picture has between a pixel's noise and a few pixels, in brightness.
class TextureExample {
 public:
  static constexpr int cell = 16;  ///< pixels
  /// The grain is a mean of 3 x 3 pixels, weighted by 1 2 1 both ways, less a mean of 9 x 9: the
  /// first leaves a third of a pixel's noise, the second no shading.
  static constexpr int mean_reach = 4;
  static constexpr float most_contrast = 2;  ///< of the median cell's; more is an edge, not grain
  static constexpr int unit = 16;            ///< grains are in sixteenths of a level

  /// Finds the cells in `part` of the picture: samples on the plane in or beside them, none in
  /// front or behind, no object, and not much more contrast than the others. Cost: 0.1 us a cell, 5
  /// ns a sample.
  void find(ImageView<Bgr> camera, const Mask& occlusion, const Rect& part,
            const std::vector<SceneSample>& samples, const BackgroundPlane& plane);

  /// Of the picture: whole cells.
  Rect part() const {
    return {first_column_ * cell, first_row_ * cell, cells_.width() * cell, cells_.height() * cell};
  }
  /// Whether the cell around a pixel is one.
  bool shows_plane(int x, int y) const { return part().contains(x, y) && at(x, y).is_example; }
  /// The mean colour of that cell.
  const Eigen::Array3f& mean(int x, int y) const { return at(x, y).mean; }

  /// The grain of all cells that a part of the picture touches will be needed.
  void want_grain(const Rect& touched);
  /// Computes what is needed. Cost: 1 us a cell.
  void find_grain(ImageView<Bgr> camera);
  /// In sixteenths of a level; 0 in cells that are none or not needed, and beyond the part. x, y:
  /// from the part's first pixel on.
  int grain(int x, int y) const { return grain_.bounds().contains(x, y) ? grain_(x, y) : 0; }

 private:
  struct Cell {
    Eigen::Array3f mean = Eigen::Array3f::Zero();
    float contrast = 0;
    bool on_plane = false, off_plane = false, has_object = false;
    bool is_example = false, needs_grain = false;
  };
  Cell& at(int x, int y) { return cells_(x / cell - first_column_, y / cell - first_row_); }
  const Cell& at(int x, int y) const {
    return cells_(x / cell - first_column_, y / cell - first_row_);
  }
  void mark_samples(const std::vector<SceneSample>& samples, const BackgroundPlane& plane);
  void mark_objects(const Mask& occlusion);
  void look_at(ImageView<Bgr> camera, int column, int row);
  void choose(ImageView<Bgr> camera);
  void find_grain(ImageView<Bgr> camera, int column, int row);

  int first_column_ = 0, first_row_ = 0;
  Image<Cell> cells_;
  Image<std::int16_t> grain_;  ///< of the part
  std::vector<float> contrasts_;
};

}  // namespace diminish
