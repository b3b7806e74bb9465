#pragma once

#include <cstddef>
#include <vector>

#include "blend/camera_place.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"

namespace diminish {

/// How far each of several RGB-D cameras is trusted, smoothly over the region. The three measures
/// are those of Buehler et al. 2001 (Unstructured Lumigraph Rendering, section 3):
///
///   resolution   pixels of the RGB-D camera's colour image per pixel of the picture; more than 1
///   does
///                not help. It falls where a surface is far from the camera or seen edge-on.
///   angle        between the lines of sight of the RGB-D camera and the colour camera: errors from
///                depth noise and from shine grow with it.
///   coverage     a camera's confidence fades to 0 towards the end of the surface that it sees,
///   over
///                `fading_px` pixels.
///
/// Stored in cells of 8x8 pixels, averaged over 5x5 cells.
class ConfidenceGrid {
 public:
  static constexpr int cell_px = 8;
  /// Neighbouring cells on each side that must be covered too.
  static constexpr int reach = 2;
  /// The distance from the last pixel of a covered cell beside an uncovered one to full confidence.
  static constexpr int fading_px = (reach + 2) * cell_px;
  /// For triangles that noise turns edge-on.
  static constexpr float least_resolution = 1e-4F;
  /// Radians; smaller angles are hardly better.
  static constexpr float least_angle = 0.05F;
  /// More pixels than this do not improve a mean.
  static constexpr float most_resolution = 4;
  /// The resolution of an uncovered cell: a mean that includes one is negative.
  static constexpr float not_covered = -1e6F;
  /// Weights of a cell and its neighbours along rows and columns, in the final means.
  static constexpr float smoothing[3] = {0.25F, 0.5F, 0.25F};

  void begin(const Rect& region, const Intrinsics& color, std::size_t cameras);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// A cell's pixels, relative to the region's corner. The last cells of a row or column take the
  /// rest.
  Rect cell(int column, int row) const;

  /// Sets a cell. resolution: see above; 0 where the cell has pixels that show another surface.
  /// z_m: in the colour camera's frame.
  void set(std::size_t camera, int column, int row, float resolution, float z_m);
  /// Call when all cells are set. Different cameras may run in different threads.
  void finish(std::size_t camera, const CameraPlace& place);

  /// The confidence in each pixel of a row, relative to the region's corner; 0 to 1 / least_angle.
  /// nodes: scratch memory.
  void row(std::size_t camera, int y, std::vector<float>& nodes, float* confidence) const;

 private:
  struct Camera {
    Image<float> resolution, z_m;
    Image<float> confidence, scratch;
  };

  void trust(Camera& camera, const CameraPlace& place) const;

  Rect region_;
  Intrinsics color_;
  int columns_ = 0, rows_ = 0;
  std::vector<Camera> cameras_;
};

}  // namespace diminish
