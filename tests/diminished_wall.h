#pragma once

#include <opencv2/imgproc.hpp>

#include "core/mat.h"
#include "diminish/diminished_frame.h"
#include "lit_wall.h"
#include "reconstruct/clear_outside.h"
#include "scene/cast_shadows.h"

namespace diminish::testing {

/// A made-up reconstruction of a lit wall with bumps and holes, from two cameras with different
/// colours, partly blended, and a ragged object.
struct DiminishedWall : LitWall {
  DiminishedWall()
      : frame({}, {{-0.45, 0.3, 0.9}, {0.4, 0.2, 1}}), planes(rig.color), shadows(rig.color) {
    planes.find({100, 80, 100, 90}, at_pixels(samples));
    shadows.find(planes.planes(), samples, box_points);
    masks = empty_masks(frame.rig);
    depths = depths_of(frame.frame);
    remove_blobs();
    make_picture();
    make_reconstruction();
  }

  std::vector<SceneSample>& at_pixels(std::vector<SceneSample>& all) {
    const Lens lens(rig.color);
    for (std::size_t i = 0; i < all.size(); ++i) {
      SceneSample& sample = all[i];
      if (const auto pixel = lens.project(sample.point_m.cast<double>())) {
        sample.pixel = pixel->cast<float>();
      }
      sample.even = true;
      sample.source = i < all.size() / 2 ? 1 : 2;
    }
    return all;
  }

  void remove_blobs() {
    for (int i = 0; i < 7; ++i) {
      const cv::Point middle(region.x + 40 + static_cast<int>(random() % 160),
                             region.y + 30 + static_cast<int>(random() % 130));
      cv::circle(as_mat(masks.color), middle, 6 + static_cast<int>(random() % 24), 255, cv::FILLED);
    }
  }

  /// Noise over gradients, and lines.
  void make_picture() {
    for (int y = 0; y < frame.frame.color.height(); ++y) {
      for (int x = 0; x < frame.frame.color.width(); ++x) {
        const auto level = [&](int base) {
          return static_cast<std::uint8_t>(base + static_cast<int>(random() % 9));
        };
        frame.frame.color.own()(x, y) = {level(60 + x / 4), level(150 - y / 3),
                                         level(90 + (x + y) / 8)};
        if (masks.color(x, y) != 0 && (x + 2 * y) % 19 < 3) frame.frame.color.own()(x, y).g += 90;
      }
    }
  }

  void make_reconstruction() {
    Reconstruction& made = expected.reconstruction;
    clear_outside(frame.rig.color, region, made);
    SecondView& second = made.second;
    resize_second(true, frame.rig.color, second);
    second.color.fill({});
    second.source.fill(0);
    second.share.fill(0);
    const Lens lens(rig.color);
    for (int y = region.y; y < region.bottom(); ++y) {
      for (int x = region.x; x < region.right(); ++x) {
        if (random() % 16 == 0 || (x / 23 + y / 17) % 5 == 0) continue;  // holes, small and large
        const Eigen::Vector2f ray = lens.undistort({x, y}).cast<float>();
        const float bump_m = (x / 31 + y / 29) % 3 == 0 ? 0.001F * static_cast<float>(x % 80) : 0.F;
        made.depth_m(x, y) = 1 / plane.inverse_depth(ray.x(), ray.y()) - bump_m;
        made.source(x, y) = static_cast<std::uint8_t>(1 + (x + y / 3) / 100 % 2);
        const Bgr& seen = frame.frame.color(x, y);
        const auto dyed = [&](int level, double gain) {
          return static_cast<std::uint8_t>(std::clamp(gain * level + 4, 0.0, 255.0));
        };
        const double gain = made.source(x, y) == 1 ? 0.8 : 1.2;
        made.color(x, y) = {dyed(seen.b, gain), dyed(seen.g, 0.9), dyed(seen.r, 1 / gain), 255};
        if ((x / 41 + y / 37) % 3 == 0) continue;
        second.color(x, y) = {dyed(seen.b, 1), dyed(seen.g, gain), dyed(seen.r, 1), 255};
        second.source(x, y) = static_cast<std::uint8_t>(3 - made.source(x, y));
        second.share(x, y) = static_cast<std::uint8_t>(1 + random() % 128);
      }
    }
  }

  Rect region{37, 21, 251, 203};
  AnalyticFrame frame;
  BackgroundPlanes planes;
  CastShadows shadows;
  OcclusionMasks masks;
  DepthImages depths;
  DiminishedFrame expected;  ///< its reconstruction, without surfaces
};

}  // namespace diminish::testing
