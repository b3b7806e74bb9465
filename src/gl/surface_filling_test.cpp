#include "gl/surface_filling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "diminish/frame_source.h"
#include "diminish/inpainter.h"
#include "diminish/pipeline.h"
#include "gl/context.h"
#include "inpaint/plane_colors.h"
#include "paths.h"
#include "picture_difference.h"

namespace diminish {
namespace {

/// What is to be filled, as the compositor knows it.
struct Task {
  Image<Bgr> picture;
  Image<std::uint8_t> provenance;
  Surfaces surfaces;

  Mask where(auto condition) const {
    Mask mask(picture.width(), picture.height(), 0);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      mask.data()[i] = condition(provenance.data()[i]) ? 255 : 0;
    }
    return mask;
  }
  Mask missing() const {
    return where([](std::uint8_t code) { return code == provenance::inpainted; });
  }
  Mask occlusion() const {
    return where([](std::uint8_t code) { return code != provenance::camera; });
  }
  bool fill_on_cpu(Image<Bgr>& filled) const {
    filled = picture;
    return Registry<Inpainter>::get("surfaces")()->inpaint({missing(), occlusion(), surfaces}, {},
                                                           filled);
  }
};

/// The filling in a context of its own, with uploads and downloads around it.
class Gpu {
 public:
  Gpu() {
    context_.run([&] {
      resources_ = std::make_unique<Resources>(context_.driver().software);
      context_.check("a test");
    });
  }
  ~Gpu() {
    context_.run([&] { resources_.reset(); });
  }

  /// Fills the task's picture; its provenance becomes what the GPU makes of it.
  void fill(Task& task) {
    context_.run([&] { fill_in_context(task); });
  }

 private:
  void fill_in_context(Task& task) {
    Resources& r = *resources_;
    const Rect whole = task.picture.bounds();
    const bool has_surfaces = !task.surfaces.label.empty();
    const Rect region = has_surfaces ? task.surfaces.region : Rect{};
    const Rect window = intersect(grow(bounding_box(task.occlusion()), 1), whole);
    std::vector<std::uint32_t> values;
    for (const Bgr& color : task.picture) {
      values.push_back(color.b | color.g << 8U | color.r << 16U);
    }
    upload(values, r.picture);
    values.assign(task.provenance.begin(), task.provenance.end());
    upload(values, r.provenance);
    values.assign(1, 0);
    for (int y = region.y; y < region.bottom(); ++y) {
      const std::uint8_t* row = task.surfaces.label.row(y);
      values.insert(values.end() - 1, row + region.x, row + region.right());
    }
    upload(values, r.surface);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    r.timer.begin_frame();
    r.filling.fill({r.picture, r.provenance, r.surface}, whole, region, window, r.timer);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    values.resize(task.picture.size());
    download(r.picture, values);
    std::transform(values.begin(), values.end(), task.picture.begin(), [](std::uint32_t value) {
      return Bgr{static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U),
                 static_cast<std::uint8_t>(value >> 16U)};
    });
    download(r.provenance, values);
    std::transform(values.begin(), values.end(), task.provenance.begin(),
                   [](std::uint32_t value) { return static_cast<std::uint8_t>(value); });
    context_.check("filling");
    std::vector<GpuPass> passes;
    r.timer.read(passes);
    for (const GpuPass& pass : passes) {
      ::testing::Test::RecordProperty(std::string(pass.name) + "_us",
                                      static_cast<int>(1000 * pass.milliseconds));
    }
  }

  struct Resources {
    explicit Resources(bool software) : timer(software) {}
    gl::SurfaceFilling filling;
    gl::Buffer picture, provenance, surface;
    gl::PassTimer timer;
  };

  static void upload(const std::vector<std::uint32_t>& values, gl::Buffer& buffer) {
    const std::size_t bytes = values.size() * sizeof(values[0]);
    gl::MappedBuffer mapped(gl::MappedBuffer::Use::upload);
    mapped.reserve(bytes);
    buffer.reserve(bytes);
    std::copy(values.begin(), values.end(), reinterpret_cast<std::uint32_t*>(mapped.data()));
    gl::copy(mapped.name(), buffer.name(), bytes);
  }
  static void download(const gl::Buffer& buffer, std::vector<std::uint32_t>& values) {
    const std::size_t bytes = values.size() * sizeof(values[0]);
    gl::MappedBuffer mapped(gl::MappedBuffer::Use::download);
    mapped.reserve(bytes);
    gl::copy(buffer.name(), mapped.name(), bytes);
    glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    gl::wait_until_done();
    const auto* data = reinterpret_cast<const std::uint32_t*>(mapped.data());
    std::copy(data, data + values.size(), values.begin());
  }

  gl::Context context_;
  std::unique_ptr<Resources> resources_;
};

/// All pixels; those to fill, and of them those that differ by more than two levels.
void expect_same_as_cpu(Gpu& gpu, const Task& task, const std::string& what) {
  Task filled = task;
  Image<Bgr> expected;
  const bool is_known = task.fill_on_cpu(expected);
  gpu.fill(filled);
  std::size_t pixels = 0;
  std::size_t other = 0;
  int most = 0;
  for (std::size_t i = 0; i < task.picture.size(); ++i) {
    if (task.provenance.data()[i] != provenance::inpainted) {
      ASSERT_EQ(filled.picture.data()[i], task.picture.data()[i]) << what;
      ASSERT_EQ(filled.provenance.data()[i], task.provenance.data()[i]) << what;
      continue;
    }
    const int levels = testing::difference(filled.picture.data()[i], expected.data()[i]);
    ++pixels;
    other += levels > 2 ? 1 : 0;
    most = std::max(most, levels);
    ASSERT_EQ(filled.provenance.data()[i], is_known ? provenance::inpainted : provenance::unknown)
        << what;
  }
  EXPECT_GT(pixels, 0U) << what;
  EXPECT_LE(other * 1000, pixels) << what << ": at most " << most;
}

constexpr std::uint8_t wall = surface_label::first_plane;
constexpr std::uint8_t table = wall + 1;
constexpr std::uint8_t floor_plane = wall + 2;

/// Always the same.
struct Noise {
  std::uint32_t state = 1;
  int below(int end) {
    state = state * 1664525U + 1013904223U;
    return static_cast<int>((state >> 8U) % static_cast<std::uint32_t>(end));
  }
};

/// A wall above a table that ends in a slope, colours that vary, a foreground; the object is
/// ragged, has a shadow, and is seen here and there by an RGB-D camera.
Task ragged_scene(int width, int height, const Rect& region, std::uint32_t seed) {
  Noise noise{seed};
  Task task;
  task.picture.resize(width, height);
  task.provenance.resize(width, height, provenance::camera);
  Surfaces& surfaces = task.surfaces;
  surfaces.region = region;
  surfaces.label.resize(width, height, surface_label::unknown);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_wall = y < height / 2 + x / 8;
      const bool is_box = x > width / 3 && x < width / 3 + width / 8 && y > height / 4;
      const auto level = [&](int base) {
        return static_cast<std::uint8_t>(std::clamp(base + noise.below(9), 0, 255));
      };
      const int shade = x * 60 / width + y * 40 / height;
      task.picture(x, y) = is_box    ? Bgr{level(200), level(30), level(30)}
                           : is_wall ? Bgr{level(90 + shade), level(120), level(140)}
                                     : Bgr{level(40), level(90 - shade / 2), level(160)};
      surfaces.label(x, y) = is_box ? surface_label::foreground : is_wall ? wall : table;
      if (noise.below(200) == 0) surfaces.label(x, y) = surface_label::unknown;
    }
  }
  // Discs of all sizes, many of which meet.
  for (int i = 0; i < 40; ++i) {
    const int radius = 1 + noise.below(i < 6 ? height / 5 : 12);
    const int center_x = noise.below(width);
    const int center_y = noise.below(height);
    const bool is_seen = i % 4 == 3;
    for (int y = std::max(center_y - radius - 3, 0); y < std::min(center_y + radius + 4, height);
         ++y) {
      for (int x = std::max(center_x - radius - 3, 0); x < std::min(center_x + radius + 4, width);
           ++x) {
        const int square = (x - center_x) * (x - center_x) + (y - center_y) * (y - center_y);
        if (square > (radius + 3) * (radius + 3)) continue;
        if (square > radius * radius) {
          if (task.provenance(x, y) == provenance::camera) task.picture(x, y) = {20, 25, 30};
          continue;
        }
        task.provenance(x, y) = is_seen ? provenance::first_rgbd : provenance::inpainted;
        // Planes go on behind what is in front of them.
        if (surfaces.label(x, y) == surface_label::foreground && !is_seen) {
          surfaces.label(x, y) = y < height / 2 + x / 8 ? wall : table;
        }
      }
    }
  }
  return task;
}

TEST(GlSurfaceFilling, FillsRaggedHolesOfSeveralPlanes) {
  Gpu gpu;
  expect_same_as_cpu(gpu, ragged_scene(320, 240, {0, 0, 320, 240}, 1), "whole region");
  expect_same_as_cpu(gpu, ragged_scene(331, 247, {13, 9, 290, 221}, 2), "part of it");
  expect_same_as_cpu(gpu, ragged_scene(95, 401, {0, 0, 95, 401}, 3), "narrow");
  expect_same_as_cpu(gpu, ragged_scene(9, 7, {0, 0, 9, 7}, 4), "tiny");
  Task without = ragged_scene(320, 240, {}, 5);
  without.surfaces.label = {};
  expect_same_as_cpu(gpu, without, "no surfaces");
}

// A plane none of which is seen is filled from what has been filled around it.
TEST(GlSurfaceFilling, FillsWhatNothingIsKnownOfFromAround) {
  Gpu gpu;
  Task task = ragged_scene(320, 240, {0, 0, 320, 240}, 6);
  task.provenance.fill({100, 60, 120, 120}, provenance::inpainted);
  task.surfaces.label.fill({90, 50, 140, 140}, wall);
  task.surfaces.label.fill({120, 80, 60, 70}, floor_plane);
  task.surfaces.label.fill({150, 100, 40, 30}, floor_plane + 1);
  expect_same_as_cpu(gpu, task, "planes within a hole");
  // Afterwards there is none again.
  expect_same_as_cpu(gpu, ragged_scene(320, 240, {0, 0, 320, 240}, 7), "no rest");
}

TEST(GlSurfaceFilling, SaysThatNothingIsKnown) {
  Gpu gpu;
  Task task = ragged_scene(64, 48, {0, 0, 64, 48}, 8);
  task.provenance.fill(provenance::inpainted);
  expect_same_as_cpu(gpu, task, "nothing known");
}

TEST(GlSurfaceFilling, GivesTheSameEveryTime) {
  Gpu gpu;
  Task a = ragged_scene(320, 240, {0, 0, 320, 240}, 9);
  Task b = a;
  gpu.fill(a);
  gpu.fill(b);
  EXPECT_EQ(a.picture, b.picture);
}

class GlSurfaceFillingOnRecordings : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Recordings, GlSurfaceFillingOnRecordings,
                         ::testing::Values("calendar", "ball", "workbench"));

TEST_P(GlSurfaceFillingOnRecordings, FillsAsTheCpuDoes) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / GetParam());
  const auto source = open_recording(recording, {});
  Options options;
  options.complete_sides = false;  // not on the GPU
  options.draw_bars = false;       // likewise
  options.close_gaps = false;      // likewise
  Pipeline pipeline(recording.rig, recording.scene, options);
  Gpu gpu;
  FrameSet frame;
  DiminishedFrame result;
  for (int i = 0; i < 3 && source->next(frame); ++i) {
    pipeline.process(frame, result);
    expect_same_as_cpu(gpu, {result.picture, result.provenance, result.surfaces}, frame.name);
  }
}

}  // namespace
}  // namespace diminish
