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
///   resolution   pixels of the RGB-D camera's colour image for one of the picture; above 1 more do
///                not help. It falls where a surface is far from the camera or seen edge-on.
///   angle        between the lines of sight of the RGB-D camera and the colour camera: what depth
///                noise shifts, and shine changes, grows with it.
///   coverage     a camera's confidence fades to 0 before the surface that it sees ends, over
///                `fading_px` pixels.
///
/// Known in cells of 8x8 pixels, of means over 5x5 cells.
class ConfidenceGrid {
 public:
  static constexpr int cell_px = 8;
  /// Neighbouring cells on each side that must be covered, too.
  static constexpr int reach = 2;
  /// From the last pixel of a covered cell beside one that is not, to full confidence.
  static constexpr int fading_px = (reach + 2) * cell_px;
  /// Triangles that noise turns edge-on.
  static constexpr float least_resolution = 1e-4F;
  /// Of the angle, radians: below this smaller ones are not much better.
  static constexpr float least_angle = 0.05F;
  /// More pixels than these do not help a mean, either.
  static constexpr float most_resolution = 4;
  /// Stands for the resolution of a cell that is not covered: a mean with one of them is negative.
  static constexpr float not_covered = -1e6F;
  /// Of a cell and its neighbours along rows and columns, in the final means.
  static constexpr float smoothing[3] = {0.25F, 0.5F, 0.25F};

  void begin(const Rect& region, const Intrinsics& color, std::size_t cameras);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// A cell's pixels, relative to the region's corner. The last ones of a row or column take what
  /// is left of it.
  Rect cell(int column, int row) const;

  /// What is known of a cell. resolution: see above; 0 where the camera's surface is not the one
  /// that is seen in all of its pixels. z_m: in the colour camera's frame.
  void set(std::size_t camera, int column, int row, float resolution, float z_m);
  /// Once all cells are set: different cameras in different threads.
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
