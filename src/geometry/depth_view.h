#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "diminish/image.h"
#include "diminish/rig.h"
#include "geometry/point_projection.h"
#include "geometry/point_rows.h"

namespace diminish {

/// What an RGB-D camera's depth image says of points in the colour camera's frame.
class DepthView {
 public:
  explicit DepthView(const RgbdCamera& camera)
      : lens_(Lens(camera.depth)), unit_m_(static_cast<float>(camera.depth_unit_m)) {}

  /// Looks at an image, which must outlive all that is asked. objects: what the image shows there
  /// is not told; empty: all is.
  void begin(ImageView<std::uint16_t> depth, ImageView<std::uint8_t> objects,
             const RigidTransform& depth_from_color) {
    depth_ = depth;
    objects_ = objects;
    depth_from_color_ = FloatTransform(depth_from_color);
  }
  /// There is no image.
  void clear() { depth_ = {}; }
  bool empty() const { return depth_.empty(); }

  /// Both z in the depth sensor's frame.
  struct Depth {
    float measured_m;  ///< 0: no depth was measured
    float own_m;       ///< the point's
    int x, y;          ///< the pixel
  };
  /// Nothing for a point outside the image, or where it shows an object.
  std::optional<Depth> at(const Eigen::Vector3f& point_m) const {
    if (depth_.empty()) return std::nullopt;
    const Eigen::Vector3f point = transform(depth_from_color_, point_m);
    const auto pixel = project(lens_, point);
    if (!pixel || !depth_.bounds().contains(pixel->x, pixel->y)) return std::nullopt;
    return at(pixel->x, pixel->y, point.z());
  }
  /// Whether no depth was measured there, and the point lies between depths that were, up to
  /// `gap_reach` pixels away in the pixel's row and column; or up to `tolerance` beyond, which is
  /// relative, and then `tolerance_m`.
  bool is_in_gap(const Depth& place, float tolerance, float tolerance_m) const;
  static constexpr int gap_reach = 60;
  static constexpr int few = 16;
  /// The same of up to `few` points, on vector instructions: calls visit(i, depth) for those of
  /// which there is something to tell.
  template <class Visit>
  void for_each(const PointRow& points, const Visit& visit) const {
    for_each_pixel(points, [&](std::size_t i, int x, int y, float own_m) {
      if (const auto depth = at(x, y, own_m)) visit(i, *depth);
    });
  }
  /// Only for those at which no depth was measured.
  template <class Visit>
  void for_each_bare(const PointRow& points, const Visit& visit) const {
    for_each_pixel(points, [&](std::size_t i, int x, int y, float own_m) {
      if (depth_(x, y) == 0 && !shows_object(x, y)) visit(i, Depth{0, own_m, x, y});
    });
  }

 private:
  bool shows_object(int x, int y) const {
    return objects_.bounds().contains(x, y) && objects_(x, y) != 0;
  }
  std::optional<Depth> at(int x, int y, float own_m) const {
    if (shows_object(x, y)) return std::nullopt;
    return Depth{unit_m_ * static_cast<float>(depth_(x, y)), own_m, x, y};
  }
  /// Calls visit(i, x, y, own_m) for those of up to `few` points that are in the image.
  template <class Visit>
  void for_each_pixel(const PointRow& points, const Visit& visit) const {
    if (depth_.empty()) return;
    constexpr unsigned pitch = 1 << 16;
    std::array<std::int32_t, few> pixels;
    std::array<float, few> own_m;
    find_pixels(points, {depth_from_color_, lens_, depth_.bounds(), static_cast<int>(pitch)},
                pixels.data(), own_m.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
      if (pixels[i] < 0) continue;
      const auto pixel = static_cast<unsigned>(pixels[i]);
      visit(i, static_cast<int>(pixel % pitch), static_cast<int>(pixel / pitch), own_m[i]);
    }
  }

  Projection lens_;
  float unit_m_;
  FloatTransform depth_from_color_{RigidTransform{}};
  ImageView<std::uint16_t> depth_;
  ImageView<std::uint8_t> objects_;
};

}  // namespace diminish
