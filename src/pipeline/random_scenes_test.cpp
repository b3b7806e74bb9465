#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "diminish/pipeline.h"
#include "picture_difference.h"
#include "random_scene.h"

namespace diminish {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RandomScene;

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

/// How many pixels of masks differ.
struct Differences {
  std::size_t pixels = 0, seen = 0, other_source = 0, other_color = 0;

  void add(const DiminishedFrame& expected, const DiminishedFrame& result) {
    for (int y = 0; y < expected.mask.height(); ++y) {
      for (int x = 0; x < expected.mask.width(); ++x) {
        if (expected.mask(x, y) == 0) continue;
        ++pixels;
        const std::uint8_t source = expected.provenance(x, y);
        seen += source >= provenance::first_rgbd && source < provenance::witnessed ? 1U : 0U;
        other_source += result.provenance(x, y) != source ? 1U : 0U;
        const int levels = testing::difference(result.picture(x, y), expected.picture(x, y));
        other_color += levels > 1 ? 1U : 0U;
      }
    }
  }
};

class RandomScenesElsewhere : public ::testing::TestWithParam<const char*> {};
#ifdef DIMINISH_HAS_GL
INSTANTIATE_TEST_SUITE_P(Backends, RandomScenesElsewhere, ::testing::Values("reference", "gl"));
#else
INSTANTIATE_TEST_SUITE_P(Backends, RandomScenesElsewhere, ::testing::Values("reference"));
#endif

// The first random scenes in which much is drawn, drawn plainly and on the GPU. Depth of noise is
// joined or torn by its last bits, which rounding decides: a pixel may differ here and there.
TEST_P(RandomScenesElsewhere, AreTheCpus) {
  Differences differences;
  int scenes = 0;
  for (unsigned seed = 9000; scenes < 8 && seed < 9500; ++seed) {
    SCOPED_TRACE(seed);
    RandomScene random(seed);
    Options options = random.options();
    options.memory = "off";
    Pipeline cpu(random.rig, random.scene, options);
    const FrameSet frame = random.frame(0);
    DiminishedFrame expected;
    cpu.process(frame, expected);
    constexpr std::size_t much = 500;
    if (expected.report.valid_pixels < much) continue;
    ++scenes;
    options.backend = GetParam();
    Pipeline other(random.rig, random.scene, options);
    DiminishedFrame result;
    other.process(frame, result);
    ASSERT_THAT(result.report.messages, Not(Contains(HasSubstr("drawn by the CPU instead"))));
    ASSERT_NO_FATAL_FAILURE(expect_what_always_holds(frame, result));
    ASSERT_EQ(result.mask, expected.mask);
    differences.add(expected, result);
  }
  RecordProperty("seen", std::to_string(differences.seen));
  RecordProperty("other_source", std::to_string(differences.other_source));
  RecordProperty("other_color", std::to_string(differences.other_color));
  EXPECT_EQ(scenes, 8);
  EXPECT_GT(differences.seen, 10000U);
  EXPECT_LE(1000 * differences.other_source, differences.pixels);
  EXPECT_LE(1000 * differences.other_color, differences.pixels);
}

}  // namespace
}  // namespace diminish
