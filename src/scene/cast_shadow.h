#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "diminish/image.h"
#include "scene/background_planes.h"

namespace diminish {

/// The light that the objects to remove leave on a plane of the background, in cells around the
/// ground's origin. Cell centres are at whole numbers.
struct CastShadow {
  /// A plane with coordinates on it, in metres from the point below the centre of the objects.
  struct Ground {
    BackgroundPlane plane;
    Eigen::Vector3f origin, along_u, along_v;

    Ground() = default;
    Ground(const BackgroundPlane& plane, const Eigen::Vector3f& middle);
    Eigen::Vector2f coordinates(const Eigen::Vector3f& point_m) const {
      const Eigen::Vector3f offset = point_m - origin;
      return {along_u.dot(offset), along_v.dot(offset)};
    }
    Eigen::Vector3f point_m(const Eigen::Vector2f& place) const;
  };
  /// Light from one direction.
  struct Beam {
    /// Where it comes from; its length along the plane's normal is 1.
    Eigen::Vector3f toward;
    Eigen::Array3f share;  ///< of the plane's light, by channel
    /// By cell: up to which height above the plane an object hides it, in steps.
    Image<std::uint8_t> height;
  };
  static constexpr float cell_m = 0.02F;
  static constexpr int grid_cells = 128;
  /// Below this loss of light there is no shadow.
  static constexpr float invisible = 1.F / 256;

  /// From a place on the ground to cells, and back.
  static Eigen::Vector2f to_cells(const Eigen::Vector2f& place) {
    return place / cell_m + Eigen::Vector2f::Constant(grid_cells / 2.F);
  }
  static Eigen::Vector2f to_place(int x, int y) {
    return cell_m * (Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y)) -
                     Eigen::Vector2f::Constant(grid_cells / 2.F));
  }
  /// The cell that contains a place, as a rectangle. It may lie outside the grid.
  static Rect cell_of(const Eigen::Vector2f& place) {
    const Eigen::Vector2f at = to_cells(place);
    return {static_cast<int>(std::lrint(at.x())), static_cast<int>(std::lrint(at.y())), 1, 1};
  }

  Ground ground;
  std::uint8_t label = 0;       ///< the plane's, as in Surfaces::label
  Image<Eigen::Array3f> light;  ///< the share that is left, by cell
  float step_m = 1;             ///< of the beams' heights

  /// Those that matter.
  std::span<const Beam> beams() const { return {beams_.data(), beam_count_}; }
  /// Whether an object is between a point, anywhere above the plane, and the light. What hides the
  /// cell on the point's line away from the light hides the point, unless it is lower.
  bool is_hidden(const Eigen::Vector3f& point_m, const Beam& beam) const {
    const float height_m = ground.plane.height_m(point_m);
    const Rect cell = cell_of(ground.coordinates(point_m - height_m * beam.toward));
    return light.bounds().contains(cell.x, cell.y) &&
           step_m * static_cast<float>(beam.height(cell.x, cell.y)) > height_m;
  }
  /// The share of the light that is left at a point of the plane, of all channels: that of the
  /// nearest cell; 1 beyond the grid.
  float light_at(const Eigen::Vector3f& point_m) const;

 private:
  friend class ShadowSearch;
  std::vector<Beam> beams_;  ///< the first beam_count_ are this frame's
  std::size_t beam_count_ = 0;
};

}  // namespace diminish
