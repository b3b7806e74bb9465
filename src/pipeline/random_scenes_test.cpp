#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "diminish/occluder_settings.h"
#include "diminish/pipeline.h"

namespace diminish {
namespace {

constexpr int smallest_px = 8;  ///< sides of images that a rig may have

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

void expect_what_always_holds(const FrameSet& frame, const DiminishedFrame& result) {
  const ImageView<Bgr> input = frame.color.view();
  const auto has_its_size = [&](const auto& image) {
    return image.width() == input.width() && image.height() == input.height();
  };
  ASSERT_TRUE(has_its_size(result.picture) && has_its_size(result.mask) &&
              has_its_size(result.provenance));
  std::size_t masked = 0;
  std::size_t valid = 0;
  for (int y = 0; y < input.height(); ++y) {
    for (int x = 0; x < input.width(); ++x) {
      const std::uint8_t source = result.provenance(x, y);
      if (result.mask(x, y) == 0) {
        ASSERT_EQ(source, provenance::camera);
        continue;
      }
      ++masked;
      ASSERT_NE(source, provenance::camera);
      if (source == provenance::inpainted || source == provenance::unknown) continue;
      ++valid;
      if (source >= provenance::witnessed) continue;
      const std::size_t k = source - provenance::first_rgbd;
      ASSERT_LT(k, frame.rgbd.size());
      ASSERT_TRUE(frame.rgbd[k].available());
    }
  }
  EXPECT_EQ(result.report.mask_pixels, masked);
  EXPECT_EQ(result.report.valid_pixels, valid);
  EXPECT_EQ(result.report.missing_pixels, masked - valid);
  // What is given as the object is replaced, all of it.
  const Mask& given = frame.masks[0].color;
  for (std::size_t i = 0; i < given.size(); ++i) {
    ASSERT_TRUE(given.data()[i] == 0 || result.mask.data()[i] != 0);
  }
}

void expect_untouched(const FrameSet& frame, const DiminishedFrame& result) {
  const ImageView<Bgr> input = frame.color.view();
  for (int y = 0; y < input.height(); ++y) {
    for (int x = 0; x < input.width(); ++x) {
      ASSERT_TRUE(result.mask(x, y) != 0 || result.picture(x, y) == input(x, y));
    }
  }
}

/// Where a triangle of an RGB-D camera's depth image may be seen: the boxes of all that are before
/// the colour camera, whatever rules choose among them. Computed in double precision, from the
/// lens's definition.
Mask reach_of_triangles(const Rig& rig, const FrameSet& frame, const Poses& poses) {
  constexpr int rounding_px = 1;
  Mask reach(rig.color.width, rig.color.height, 0);
  const Lens color(rig.color);
  for (std::size_t k = 0; k < rig.rgbd.size(); ++k) {
    if (!poses.color_from_depth[k] || !frame.rgbd[k].available()) continue;
    const Lens sensor(rig.rgbd[k].depth);
    const ImageView<std::uint16_t> depth = frame.rgbd[k].depth;
    const auto place = [&](int x, int y) -> std::optional<Eigen::Vector2d> {
      if (depth(x, y) == 0) return std::nullopt;
      const Eigen::Vector2d ray = sensor.undistort(Eigen::Vector2d(x, y));
      const double depth_m = depth(x, y) * rig.rgbd[k].depth_unit_m;
      return color.project(*poses.color_from_depth[k] * (depth_m * ray.homogeneous()).eval());
    };
    const auto mark = [&](const auto& a, const auto& b, const auto& c) {
      if (!a || !b || !c) return;
      const Eigen::Vector2d low = a->cwiseMin(*b).cwiseMin(*c).cwiseMax(-1e6);
      const Eigen::Vector2d high = a->cwiseMax(*b).cwiseMax(*c).cwiseMin(1e6);
      const int left = static_cast<int>(std::floor(low.x())) - rounding_px;
      const int top = static_cast<int>(std::floor(low.y())) - rounding_px;
      const Rect box = {left, top, static_cast<int>(std::ceil(high.x())) + rounding_px + 1 - left,
                        static_cast<int>(std::ceil(high.y())) + rounding_px + 1 - top};
      reach.fill(intersect(box, reach.bounds()), 255);
    };
    for (int y = 0; y + 1 < depth.height(); ++y) {
      for (int x = 0; x + 1 < depth.width(); ++x) {
        mark(place(x, y), place(x + 1, y), place(x, y + 1));
        mark(place(x + 1, y), place(x + 1, y + 1), place(x, y + 1));
      }
    }
  }
  return reach;
}

class RandomScenes : public ::testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, RandomScenes, ::testing::Range(0U, 10U));

TEST_P(RandomScenes, KeepWhatIsPromised) {
  namespace tbb = oneapi::tbb;
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 3);
  std::size_t valid = 0;
  std::size_t missing = 0;
  for (unsigned i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    RandomScene random(100 * GetParam() + i);
    const Options options = random.options();
    Pipeline alone(random.rig, random.scene, options);
    Pipeline shared(random.rig, random.scene, options);
    for (std::size_t index = 0; index < 3; ++index) {
      const FrameSet frame = random.frame(index);
      DiminishedFrame result;
      DiminishedFrame same;
      tbb::task_arena(1).execute([&] { alone.process(frame, result); });
      tbb::task_arena(3).execute([&] { shared.process(frame, same); });
      ASSERT_NO_FATAL_FAILURE(expect_what_always_holds(frame, result));
      if (!options.remove_shadows) {
        ASSERT_NO_FATAL_FAILURE(expect_untouched(frame, result));
      }
      ASSERT_EQ(result.picture, same.picture);
      ASSERT_EQ(result.provenance, same.provenance);
      valid += result.report.valid_pixels;
      missing += result.report.missing_pixels;
    }
  }
  // Else nothing was tried.
  EXPECT_GT(valid, 100U);
  EXPECT_GT(missing, 100U);
}

// Behind the camera, edge-on, or across the whole picture: nothing is drawn but triangles.
TEST_P(RandomScenes, ShowNothingWhereNoTriangleIs) {
  std::size_t drawn = 0;
  std::size_t empty = 0;
  for (unsigned i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    RandomScene random(5000 + 100 * GetParam() + i);
    Options options = random.options();
    options.memory = "off";
    options.whole_view = true;
    options.refine_poses = false;
    // Depths as they are
    options.smooth_depth = options.snap_edges = false;
    Pipeline pipeline(random.rig, random.scene, options);
    const FrameSet frame = random.frame(0);
    DiminishedFrame result;
    pipeline.process(frame, result);
    const Mask reach = reach_of_triangles(random.rig, frame, result.report.poses);
    const Image<Bgra>& color = result.reconstruction.color;
    ASSERT_EQ(color.width(), reach.width());
    for (int y = 0; y < color.height(); ++y) {
      for (int x = 0; x < color.width(); ++x) {
        const Bgra& pixel = color(x, y);
        if (pixel.a == 0) {
          ++empty;
          ASSERT_EQ(pixel.b + pixel.g + pixel.r, 0);
          ASSERT_EQ(result.reconstruction.source(x, y), 0);
          continue;
        }
        ++drawn;
        ASSERT_NE(reach(x, y), 0) << x << " " << y;
        ASSERT_GT(result.reconstruction.depth_m(x, y), 0);
      }
    }
  }
  EXPECT_GT(drawn, 10U);
  EXPECT_GT(empty, 100U);
}

}  // namespace
}  // namespace diminish
