#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <string>

#include "diminish/config.h"
#include "diminish/frame_set.h"
#include "diminish/occluder_settings.h"
#include "diminish/options.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish::testing {

inline constexpr int smallest_px = 8;  ///< sides of images that a rig may have

/// Cameras, images and masks that no one would make on purpose: a few pixels high, looking away
/// from one another, depth without sense, masks in a thousand pieces.
class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : random_(seed) {
    rig.color = sensor();
    std::string poses = "{source: fixed, color_from_rgbd: {";
    const int cameras = 1 + below(3);
    for (int k = 0; k < cameras; ++k) {
      RgbdCamera camera;
      camera.name = "rgbd" + std::to_string(k);
      camera.color = sensor();
      camera.depth = sensor();
      camera.depth_unit_m = below(2) == 0 ? 0.001 : 0.0001;
      camera.color_from_depth.translation = {0.05, 0, 0};
      poses += (k > 0 ? ", " : "") + camera.name + ": " + pose();
      rig.rgbd.push_back(camera);
    }
    rig.pose_source = "fixed";
    rig.pose = Config::parse(poses + "}}");
    auto settings = std::make_shared<MaskSettings>();
    settings->color = "masks/color";
    scene.occluders = {{"object", "mask", settings}};
    if (below(3) == 0) {
      auto difference = std::make_shared<DifferenceSettings>();
      difference->clearance = uniform(0.05, 0.95);
      scene.occluders.push_back({"anything", "difference", difference});
    }
  }

  FrameSet frame(std::size_t index) {
    FrameSet frame;
    frame.index = index;
    frame.name = std::to_string(index);
    frame.stamp_s = static_cast<double>(index) / 30;
    frame.color = color_image(rig.color);
    GivenMask mask{"object", mask_image(rig.color), {}};
    for (const RgbdCamera& camera : rig.rgbd) {
      RgbdFrame rgbd;
      rgbd.color = color_image(camera.color);
      rgbd.depth = depth_image(camera.depth);
      if (below(8) == 0) rgbd.missing = camera.name + ": unplugged";
      frame.rgbd.push_back(std::move(rgbd));
      mask.rgbd.push_back(below(2) == 0 ? Mask() : mask_image(camera.color));
    }
    frame.masks.push_back(std::move(mask));
    return frame;
  }

  Options options() {
    Options options;
    options.memory = below(2) == 0 ? "off" : "on";
    options.inpaint = std::array{"structure", "surfaces", "harmonic", "none"}[pick(4)];
    options.color_correct =
        std::array{"field_membrane", "poisson", "affine_membrane", "none"}[pick(4)];
    options.mask_margin_px = below(12);
    options.remove_shadows = below(2) == 0;
    options.whole_view = below(3) == 0;
    return options;
  }

  Rig rig;
  Scene scene;

 private:
  int below(int end) { return std::uniform_int_distribution(0, end - 1)(random_); }
  std::size_t pick(int count) { return static_cast<std::size_t>(below(count)); }
  double uniform(double low, double high) {
    return std::uniform_real_distribution(low, high)(random_);
  }

  Intrinsics sensor() {
    const auto side = [&] {
      switch (below(6)) {
        case 0:
          return smallest_px + below(3);
        case 1:
          return 64 * (1 + below(4)) + 1;  // threads share rows in bands: the last has one
        default:
          return smallest_px + below(150);
      }
    };
    Intrinsics sensor{side(), side(), 0, 0, 0, 0, {}};
    const double focal_px = uniform(0.4, 3) * std::max(sensor.width, sensor.height);
    sensor.fx = sensor.fy = focal_px;
    sensor.cx = uniform(0, sensor.width);
    sensor.cy = uniform(0, sensor.height);
    if (below(2) == 0) sensor.distortion = {uniform(-0.3, 0.3), uniform(-0.3, 0.3)};
    return sensor;
  }

  std::string pose() {
    const Eigen::Vector3d axis{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const double angle = below(4) == 0 ? uniform(0, 3.1) : uniform(0, 0.2);
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, axis.normalized()).matrix();
    std::string yaml = "{rotation: [";
    for (int i = 0; i < 9; ++i)
      yaml += (i > 0 ? ", " : "") + std::to_string(rotation(i / 3, i % 3));
    yaml += "], translation: [";
    for (int i = 0; i < 3; ++i) yaml += (i > 0 ? ", " : "") + std::to_string(uniform(-0.4, 0.4));
    return yaml + "]}";
  }

  Image<Bgr> color_image(const Intrinsics& sensor) {
    Image<Bgr> image(sensor.width, sensor.height);
    const int kind = below(3);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const auto level = [&] {
          return static_cast<std::uint8_t>(kind == 0 ? below(256) : kind == 1 ? x + 2 * y : 255);
        };
        image(x, y) = {level(), level(), level()};
      }
    }
    return image;
  }

  Image<std::uint16_t> depth_image(const Intrinsics& sensor) {
    Image<std::uint16_t> image(sensor.width, sensor.height);
    const int kind = below(5);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const int plane = 1000 + 3 * x + y;
        const int value = kind == 0   ? below(65536)
                          : kind == 1 ? 0
                          : kind == 2 ? (below(3) == 0 ? 0 : plane)
                          : kind == 3 ? (x / 9 % 2 == 0 ? 65535 : plane)
                                      : plane;
        image(x, y) = static_cast<std::uint16_t>(value);
      }
    }
    return image;
  }

  Mask mask_image(const Intrinsics& sensor) {
    Mask mask(sensor.width, sensor.height, 0);
    switch (below(5)) {
      case 0:
        mask.fill(sensor.bounds(), 255);
        break;
      case 1:
        break;
      case 2:
        for (std::uint8_t& pixel : mask) pixel = below(4) == 0 ? 255 : 0;
        break;
      case 3:
        mask(below(mask.width()), below(mask.height())) = 255;
        break;
      default: {
        const int x = below(mask.width());
        const int y = below(mask.height());
        mask.fill({x, y, 1 + below(mask.width() - x), 1 + below(mask.height() - y)}, 255);
      }
    }
    return mask;
  }

  std::mt19937 random_;
};

}  // namespace diminish::testing
