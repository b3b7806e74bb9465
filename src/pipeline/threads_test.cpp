#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <cstdlib>
#include <filesystem>
#include <future>
#include <string>
#include <thread>
#include <tuple>

#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "paths.h"

namespace diminish {
namespace {

int threads_of_this_process() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<int>(std::distance(begin(tasks), end(tasks)));
}

/// How many threads a frame starts in an arena of so many.
int threads_started_in_arena_of(int size) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "workbench");
  const Options options;
  FrameSet frame;
  // Reading starts none either: images are decoded by the caller's arena, too.
  oneapi::tbb::task_arena(1).execute([&] { open_recording(recording, options)->next(frame); });
  // The thread sanitizer starts a thread of its own together with the first.
  std::promise<void> end;
  std::thread first([&] { end.get_future().wait(); });
  const int before = threads_of_this_process();
  oneapi::tbb::task_arena(size).execute([&] {
    Pipeline pipeline(recording.rig, recording.scene, options);
    DiminishedFrame result;
    pipeline.process(frame, result);
  });
  const int started = threads_of_this_process() - before;
  end.set_value();
  first.join();
  return started;
}

// In processes of their own: threads that other tests left would be used again.
TEST(PipelineThreads, AreThoseOfTheCallersArena) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::_Exit(threads_started_in_arena_of(1)), ::testing::ExitedWithCode(0), "");
  if (std::thread::hardware_concurrency() < 2) return;
  EXPECT_EXIT(std::_Exit(threads_started_in_arena_of(2)), ::testing::ExitedWithCode(1), "");
}

/// A recording, and whether shadows are removed: then less is done at the same time.
class ManyThreads : public ::testing::TestWithParam<std::tuple<const char*, bool>> {};
INSTANTIATE_TEST_SUITE_P(Recordings, ManyThreads,
                         ::testing::Combine(::testing::Values("calendar", "ball", "workbench"),
                                            ::testing::Bool()),
                         [](const auto& test) {
                           const char* const how =
                               std::get<1>(test.param) ? "_without_shadows" : "";
                           return std::string(std::get<0>(test.param)) + how;
                         });

// More of them than there are cores, so that they are taken away from one another.
TEST_P(ManyThreads, MakeTheSameBytes) {
  namespace tbb = oneapi::tbb;
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 16);
  const auto& [name, remove_shadows] = GetParam();
  const Recording recording = load_recording(testing::recordings / name);
  Options options;
  options.remove_shadows = remove_shadows;
  FrameSet frame;
  ASSERT_TRUE(open_recording(recording, options)->next(frame));
  DiminishedFrame expected;
  for (const int threads : {1, 2, 3, 4, 7, 16}) {
    DiminishedFrame result;
    tbb::task_arena(threads).execute([&] {
      Pipeline pipeline(recording.rig, recording.scene, options);
      for (int time = 0; time < 3; ++time) pipeline.process(frame, result);
    });
    if (threads == 1) expected = result;
    ASSERT_GT(result.report.valid_pixels, 1000U);
    EXPECT_EQ(result.picture, expected.picture) << threads;
    EXPECT_EQ(result.provenance, expected.provenance) << threads;
    EXPECT_EQ(result.mask, expected.mask) << threads;
    EXPECT_EQ(result.reconstruction.color, expected.reconstruction.color) << threads;
    EXPECT_EQ(result.reconstruction.depth_m, expected.reconstruction.depth_m) << threads;
    EXPECT_EQ(result.surfaces.label, expected.surfaces.label) << threads;
    EXPECT_EQ(result.surfaces.light, expected.surfaces.light) << threads;
  }
}

}  // namespace
}  // namespace diminish
