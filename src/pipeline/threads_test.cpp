#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <cstdlib>
#include <filesystem>
#include <thread>

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
  open_recording(recording, options)->next(frame);
  const int before = threads_of_this_process();
  oneapi::tbb::task_arena(size).execute([&] {
    Pipeline pipeline(recording.rig, recording.scene, options);
    DiminishedFrame result;
    pipeline.process(frame, result);
  });
  return threads_of_this_process() - before;
}

// In processes of their own: threads that other tests left would be used again.
TEST(PipelineThreads, AreThoseOfTheCallersArena) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(std::_Exit(threads_started_in_arena_of(1)), ::testing::ExitedWithCode(0), "");
  if (std::thread::hardware_concurrency() < 2) return;
  EXPECT_EXIT(std::_Exit(threads_started_in_arena_of(2)), ::testing::ExitedWithCode(1), "");
}

}  // namespace
}  // namespace diminish
