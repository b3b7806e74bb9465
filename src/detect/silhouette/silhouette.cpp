#include "detect/silhouette/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/convex_hull.h"

namespace diminish {
namespace {

constexpr double near_m = 0.01;

/// Rays (x, y, 1) or pixels.
using Polygon = std::vector<Eigen::Vector2d>;

/// Where the line through two points meets the plane (or line) with these signed distances from the
/// points.
template <class Point>
Point meeting_point(const Point& a, double distance_a, const Point& b, double distance_b) {
  return a + distance_a / (distance_a - distance_b) * (b - a);
}

/// The part of a convex polygon where `distance` is not negative (Sutherland & Hodgman 1974).
template <class Point, class SignedDistance>
void clip(const std::vector<Point>& polygon, const SignedDistance& distance,
          std::vector<Point>& result) {
  result.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& a = polygon[i];
    const Point& b = polygon[(i + 1) % polygon.size()];
    const double distance_a = distance(a);
    const double distance_b = distance(b);
    if (distance_a >= 0) result.push_back(a);
    if ((distance_a < 0) != (distance_b < 0)) {
      result.push_back(meeting_point(a, distance_a, b, distance_b));
    }
  }
}

/// The rays that can reach the picture: a regular polygon around it, within the radius where the
/// distortion polynomial folds back.
class FieldOfView {
 public:
  explicit FieldOfView(const Lens& lens) {
    // A little larger than the picture, so that the polygon's sides stay outside it.
    const double radius = std::min(1.02 * picture_radius(lens), valid_radius(lens));
    constexpr int sides = 32;
    constexpr double half_angle = std::numbers::pi / sides;
    inner_radius_ = radius * std::cos(half_angle);
    for (int i = 0; i < sides; ++i) {
      normals_.emplace_back(std::cos(2 * half_angle * i), std::sin(2 * half_angle * i));
    }
  }

  /// Cuts off the part of a convex polygon that is outside.
  void clip_to_field(Polygon& rays, Polygon& scratch) const {
    const auto inside = [this](const Eigen::Vector2d& ray) { return ray.norm() <= inner_radius_; };
    if (std::all_of(rays.begin(), rays.end(), inside)) return;
    for (const Eigen::Vector2d& normal : normals_) {
      const auto distance = [&](const Eigen::Vector2d& ray) {
        return inner_radius_ - normal.dot(ray);
      };
      clip(rays, distance, scratch);
      rays.swap(scratch);
    }
  }

 private:
  /// The largest radius of a ray on the picture's border; infinite where the lens model does not
  /// hold for the whole picture.
  static double picture_radius(const Lens& lens) {
    const Intrinsics& intrinsics = lens.intrinsics();
    constexpr int samples = 16;
    double radius = 0;
    for (int i = 0; i <= samples; ++i) {
      const double x = (intrinsics.width - 1.0) * i / samples;
      const double y = (intrinsics.height - 1.0) * i / samples;
      const double right = intrinsics.width - 1.0;
      const double bottom = intrinsics.height - 1.0;
      for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(x, 0), Eigen::Vector2d(x, bottom),
                                           Eigen::Vector2d(0, y), Eigen::Vector2d(right, y)}) {
        const Eigen::Vector2d ray = lens.undistort(pixel);
        const auto back = lens.distort(ray);
        if (!back || !((*back - pixel).norm() < 0.5)) {
          return std::numeric_limits<double>::infinity();
        }
        radius = std::max(radius, ray.norm());
      }
    }
    return radius;
  }

  /// The radius up to which the lens maps a ray to a pixel.
  static double valid_radius(const Lens& lens) {
    double valid = 0;
    double invalid = 12;  // no lens goes so far
    for (int halving = 0; halving < 50; ++halving) {
      const double middle = (valid + invalid) / 2;
      (lens.distort({middle, 0}) ? valid : invalid) = middle;
    }
    return valid * (1 - 1e-9);
  }

  double inner_radius_ = 0;
  std::vector<Eigen::Vector2d> normals_;
};

/// Outlines polygons of rays; reuses its memory.
class BentOutline {
 public:
  explicit BentOutline(const Lens& lens) : lens_(lens), field_(lens) {}

  /// Adds the image of a convex polygon of rays. Changes `rays`.
  void add(Polygon& rays, std::uint32_t object, Polygons& polygons) {
    field_.clip_to_field(rays, scratch_);
    if (rays.size() < 3) return;
    Eigen::Vector2d begin = lens_.distort(rays.back()).value();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Eigen::Vector2d& previous = i > 0 ? rays[i - 1] : rays.back();
      const Eigen::Vector2d end = lens_.distort(rays[i]).value();
      add_bent_edge(previous, begin, rays[i], end, polygons);
      begin = end;
    }
    polygons.end_polygon(object);
  }

 private:
  /// Adds the image of the edge from ray `a` to ray `b`, without its first point, as straight
  /// pieces that follow its curve.
  void add_bent_edge(const Eigen::Vector2d& a, const Eigen::Vector2d& pixel_a,
                     const Eigen::Vector2d& b, const Eigen::Vector2d& pixel_b,
                     Polygons& polygons) const {
    constexpr double always_straight_px = 4;
    constexpr double longest_px = 64;  // a longer piece could curve both ways
    constexpr double largest_bend_px = 0.02;
    const double length_px = (pixel_b - pixel_a).norm();
    if (length_px > always_straight_px) {
      const Eigen::Vector2d middle = (a + b) / 2;
      const Eigen::Vector2d pixel_middle = lens_.distort(middle).value();
      const double bend_px = (pixel_middle - (pixel_a + pixel_b) / 2).norm();
      if (length_px > longest_px || bend_px > largest_bend_px) {
        add_bent_edge(a, pixel_a, middle, pixel_middle, polygons);
        add_bent_edge(middle, pixel_middle, b, pixel_b, polygons);
        return;
      }
    }
    polygons.add_corner(pixel_b);
  }

  Lens lens_;
  FieldOfView field_;
  Polygon scratch_;
};

}  // namespace

struct Silhouette::Implementation {
  explicit Implementation(const Lens& lens) : outline(lens) {}

  BentOutline outline;
  Polygon rays, hull;
  std::vector<Eigen::Vector3d> corners, in_front;  ///< of a triangle
};

Silhouette::Silhouette(const Lens& lens)
    : implementation_(std::make_unique<Implementation>(lens)) {}
Silhouette::~Silhouette() = default;
Silhouette::Silhouette(Silhouette&&) noexcept = default;
Silhouette& Silhouette::operator=(Silhouette&&) noexcept = default;

void Silhouette::outline_convex_hull(const std::vector<Eigen::Vector3d>& points_in_camera,
                                     std::uint32_t object, Polygons& polygons) {
  auto& [outline, rays, hull, corners, in_front] = *implementation_;
  rays.clear();
  for (const Eigen::Vector3d& point : points_in_camera) {
    if (point.z() < near_m) continue;
    rays.emplace_back(point.head<2>() / point.z());
    // After cutting by the near plane, the hull has corners on lines between points on its two
    // sides.
    for (const Eigen::Vector3d& behind : points_in_camera) {
      if (behind.z() >= near_m) continue;
      const Eigen::Vector3d corner =
          meeting_point(point, point.z() - near_m, behind, behind.z() - near_m);
      rays.emplace_back(corner.head<2>() / near_m);
    }
  }
  find_convex_hull(rays, hull);
  outline.add(hull, object, polygons);
}

void Silhouette::outline_triangles(const std::vector<Eigen::Vector3d>& vertices_in_camera,
                                   const std::vector<std::array<int, 3>>& triangles,
                                   std::uint32_t object, Polygons& polygons) {
  auto& [outline, rays, hull, corners, in_front] = *implementation_;
  for (const std::array<int, 3>& triangle : triangles) {
    corners.clear();
    for (const int index : triangle) corners.push_back(vertices_in_camera[index]);
    clip(
        corners, [](const Eigen::Vector3d& point) { return point.z() - near_m; }, in_front);
    rays.clear();
    for (const Eigen::Vector3d& point : in_front) rays.emplace_back(point.head<2>() / point.z());
    outline.add(rays, object, polygons);
  }
}

bool SilhouetteDrawer::fill_convex_hull(const std::vector<Eigen::Vector3d>& points_in_camera,
                                        Mask& mask) {
  polygons_.clear();
  silhouette_.outline_convex_hull(points_in_camera, 0, polygons_);
  return fill(mask);
}

bool SilhouetteDrawer::fill_triangles(const std::vector<Eigen::Vector3d>& vertices_in_camera,
                                      const std::vector<std::array<int, 3>>& triangles,
                                      Mask& mask) {
  polygons_.clear();
  silhouette_.outline_triangles(vertices_in_camera, triangles, 0, polygons_);
  return fill(mask);
}

bool SilhouetteDrawer::fill(Mask& mask) {
  std::uint8_t covers = 0;
  filler_.fill(polygons_, mask, {&covers, 1});
  return covers != 0;
}

}  // namespace diminish
