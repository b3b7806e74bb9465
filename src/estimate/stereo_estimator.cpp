#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/rows.h"
#include "core/tasks.h"
#include "depth/visible_blocks.h"
#include "diminish/depth_estimator.h"
#include "estimate/plane_sweep/plane_sweep.h"

namespace diminish {
namespace {

/// Cameras nearer to each other than this see no parallax.
constexpr double least_baseline_m = 0.01;
/// A camera that sees less than this share of what another may see cannot tell its depth.
constexpr double least_overlap = 0.05;

/// Depth from two or more colour pictures: each camera's is swept against the picture of the camera
/// that looks most alike, and kept where a depth image of another camera agrees.
class StereoEstimator final : public DepthEstimator {
 public:
  explicit StereoEstimator(const Rig& rig) {
    for (const RgbdCamera& camera : rig.rgbd) {
      const int shrinkage = std::max(1, camera.color.width / usual_columns);
      cameras_.push_back({.rig = camera,
                          .picture = GreyPicture(camera.color, shrinkage),
                          .visible = VisibleBlocks(camera, rig.color),
                          .sweep = PlaneSweep(camera.depth)});
    }
    if (cameras_.size() < 2) {
      throw Error(Error::input,
                  fmt::format("estimate_depth stereo: expected two cameras or more beside the "
                              "user's, the rig has {}",
                              cameras_.size()));
    }
  }

  void estimate(const Inputs& inputs, std::vector<Image<std::uint16_t>>& depths,
                std::vector<std::string>& messages) override {
    for_tasks(cameras_.size(), [&](std::size_t k) { begin(inputs, k); });
    for (std::size_t k = 0; k < cameras_.size(); ++k) {
      Camera& camera = cameras_[k];
      camera.partner.reset();
      if (!inputs.wanted[k]) continue;
      camera.partner = find_partner(k);
      if (!camera.partner) {
        messages.push_back(why_alone(k));
      }
    }
    for_tasks(cameras_.size(), [&](std::size_t k) {
      if (cameras_[k].partner) sweep(inputs, k);
    });
    for_tasks(cameras_.size(), [&](std::size_t k) {
      if (!cameras_[k].partner) return;
      write(k, depths[k]);
      complete(k, depths[k]);
    });
  }

 private:
  static constexpr int usual_columns = 960;

  struct Camera {
    RgbdCamera rig;
    GreyPicture picture;
    VisibleBlocks visible;
    PlaneSweep sweep;
    std::optional<RigidTransform> user_from_color = {};  ///< unknown: it has no picture, or no pose
    std::optional<std::size_t> partner = {};
    Image<float> inverse_depth = {};
    Image<std::uint16_t> confirmed = {};
  };

  void begin(const Inputs& inputs, std::size_t k) {
    Camera& camera = cameras_[k];
    const RgbdFrame& rgbd = inputs.frame.rgbd[k];
    const auto& user_from_depth = inputs.poses.color_from_depth[k];
    camera.user_from_color.reset();
    if (!user_from_depth || !rgbd.has_picture()) return;
    camera.user_from_color = *user_from_depth * camera.rig.color_from_depth.inverse();
    // Objects are surfaces as well: it is for others to leave them out.
    camera.picture.take(rgbd.color);
  }

  RigidTransform other_from(std::size_t k, std::size_t other) const {
    return cameras_[other].user_from_color->inverse() * *cameras_[k].user_from_color;
  }

  bool is_elsewhere(std::size_t k, std::size_t other) const {
    return other != k && cameras_[other].user_from_color &&
           other_from(k, other).translation.norm() >= least_baseline_m;
  }

  /// Of the space that a camera sees within its range, the share that another one sees too: of
  /// points all over its picture, at distances whose inverses are even.
  double overlap(std::size_t k, std::size_t other) const {
    const RgbdCamera& camera = cameras_[k].rig;
    const Intrinsics& view = camera.depth;
    const Intrinsics& other_view = cameras_[other].rig.depth;
    const RigidTransform other_from_own = other_from(k, other);
    constexpr int steps = 8;
    int seen = 0;
    for (int i = 0; i < steps * steps * steps; ++i) {
      const auto part = [i](int stride) { return (i / stride % steps + 0.5) / steps; };
      const double inverse_depth =
          1 / camera.farthest_m + part(1) * (1 / camera.nearest_m - 1 / camera.farthest_m);
      const Eigen::Vector3d ray((part(steps) * view.width - view.cx) / view.fx,
                                (part(steps * steps) * view.height - view.cy) / view.fy, 1);
      const Eigen::Vector3d point = other_from_own * (ray / inverse_depth);
      if (!(point.z() > 0)) continue;
      const double u = other_view.fx * point.x() / point.z() + other_view.cx;
      const double v = other_view.fy * point.y() / point.z() + other_view.cy;
      if (u >= 0 && u < other_view.width && v >= 0 && v < other_view.height) ++seen;
    }
    return static_cast<double>(seen) / (steps * steps * steps);
  }

  /// The camera that looks in the most similar direction, of those that see the same.
  std::optional<std::size_t> find_partner(std::size_t k) const {
    std::optional<std::size_t> best;
    double best_cosine = 0;
    for (std::size_t other = 0; other < cameras_.size(); ++other) {
      if (!is_elsewhere(k, other)) continue;
      const double cosine = other_from(k, other).rotation(2, 2);
      if (cosine > best_cosine && overlap(k, other) >= least_overlap) {
        best = other;
        best_cosine = cosine;
      }
    }
    return best;
  }

  /// Why a camera has no partner.
  std::string why_alone(std::size_t k) const {
    const RgbdCamera& camera = cameras_[k].rig;
    for (std::size_t other = 0; other < cameras_.size(); ++other) {
      if (!is_elsewhere(k, other)) continue;
      return fmt::format(
          "{}: no other camera looks the same way at what it sees between {:g} and {:g} m "
          "(range_m), so its depth is not known",
          camera.name, camera.nearest_m, camera.farthest_m);
    }
    return camera.name +
           ": no other camera sees the scene from elsewhere, so its depth is not known";
  }

  void sweep(const Inputs& inputs, std::size_t k) {
    Camera& camera = cameras_[k];
    camera.visible.find(static_cast<float>(camera.rig.nearest_m),
                        static_cast<float>(camera.rig.farthest_m), *camera.user_from_color,
                        inputs.drawn);
    camera.sweep.sweep(camera.picture, cameras_[*camera.partner].picture,
                       other_from(k, *camera.partner),
                       {camera.rig.nearest_m, camera.rig.farthest_m},
                       camera.visible.part().bounds(), camera.inverse_depth);
  }

  /// Writes what the partner's depth agrees with.
  void write(std::size_t k, Image<std::uint16_t>& depth) const {
    const Camera& camera = cameras_[k];
    const Camera& witness = cameras_[*camera.partner];
    const Intrinsics& view = camera.rig.depth;
    const Rect part = intersect(camera.sweep.swept(), view.bounds());
    const RigidTransform partner_from_own = other_from(k, *camera.partner);
    const auto per_unit = static_cast<float>(1 / camera.rig.depth_unit_m);
    for_rows(part.height, [&](Rows rows) {
      for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
        // Without a depth image of its own the partner cannot object.
        const DepthRow row(view, partner_from_own, y);
        for (int x = part.x; x < part.right(); ++x) {
          const float inverse_depth = camera.inverse_depth(x, y);
          if (!(inverse_depth > 0)) continue;
          if (witness.partner && !is_confirmed(row.point(x, inverse_depth), inverse_depth, witness))
            continue;
          const float value = std::round(per_unit / inverse_depth);
          if (value < 65536) depth(x, y) = static_cast<std::uint16_t>(value);
        }
      }
    });
  }

  /// Writes what the partner does not see, or not well, but enough of what is known around it lies
  /// at the same depth.
  void complete(std::size_t k, Image<std::uint16_t>& depth) {
    Camera& camera = cameras_[k];
    Image<std::uint16_t>& known = camera.confirmed;
    known = depth;
    const Rect part = intersect(camera.sweep.swept(), camera.rig.depth.bounds());
    const auto unit = static_cast<float>(camera.rig.depth_unit_m);
    // Of 24 places around a pixel
    constexpr int reach = 6;
    constexpr int apart = 3;
    constexpr int enough = 5;
    const float tolerance = 2 * camera.sweep.step_of_pixel();
    for_rows(part.height, [&](Rows rows) {
      for (int y = part.y + rows.first; y < part.y + rows.last; ++y) {
        for (int x = part.x; x < part.right(); ++x) {
          const float own = camera.inverse_depth(x, y);
          if (known(x, y) != 0 || !(own > 0)) continue;
          int agree = 0;
          for (int dy = -reach; dy <= reach; dy += apart) {
            for (int dx = -reach; dx <= reach; dx += apart) {
              if (!part.contains(x + dx, y + dy) || known(x + dx, y + dy) == 0) continue;
              const float other = 1 / (static_cast<float>(known(x + dx, y + dy)) * unit);
              agree += std::abs(other - own) < tolerance ? 1 : 0;
            }
          }
          if (agree < enough) continue;
          depth(x, y) = static_cast<std::uint16_t>(std::lround(1 / (own * unit)));
        }
      }
    });
  }

  /// A row of a depth image, seen from another camera.
  class DepthRow {
   public:
    DepthRow(const Intrinsics& view, const RigidTransform& other_from_own, int y)
        : step_((other_from_own.rotation.col(0) / view.fx).cast<float>()),
          first_((other_from_own.rotation *
                  Eigen::Vector3d(-view.cx / view.fx, (y - view.cy) / view.fy, 1))
                     .cast<float>()),
          translation_(other_from_own.translation.cast<float>()) {}

    /// In the other camera's frame, times the inverse depth.
    Eigen::Vector3f point(int x, float inverse_depth) const {
      return first_ + static_cast<float>(x) * step_ + inverse_depth * translation_;
    }

   private:
    Eigen::Vector3f step_, first_, translation_;
  };

  /// Whether the partner's own sweep ended at the point, too.
  static bool is_confirmed(const Eigen::Vector3f& point, float inverse_depth,
                           const Camera& witness) {
    if (!(point.z() > 0)) return false;
    const Intrinsics& view = witness.rig.depth;
    const float u =
        static_cast<float>(view.fx) * point.x() / point.z() + static_cast<float>(view.cx);
    const float v =
        static_cast<float>(view.fy) * point.y() / point.z() + static_cast<float>(view.cy);
    if (!(std::abs(u) < 32768) || !(std::abs(v) < 32768)) return false;
    const int x = static_cast<int>(std::lround(u));
    const int y = static_cast<int>(std::lround(v));
    if (!witness.sweep.swept().contains(x, y) || !view.bounds().contains(x, y)) return false;
    const float found = witness.inverse_depth(x, y);
    constexpr float tolerance_px = 3;
    return found > 0 && std::abs(found - inverse_depth / point.z()) <
                            tolerance_px * witness.sweep.step_of_pixel();
  }

  std::vector<Camera> cameras_;
};

const bool stereo_estimator_registered = Registry<DepthEstimator>::add(
    "stereo", [](const Rig& rig, const Scene&) { return std::make_unique<StereoEstimator>(rig); });

}  // namespace
}  // namespace diminish
