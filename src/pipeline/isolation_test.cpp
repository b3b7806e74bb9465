#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include "core/tasks.h"
#include "diminish/pipeline.h"
#include "diminish/pose_source.h"
#include "first_frame.h"

namespace diminish {
namespace {

using namespace std::chrono_literals;

std::function<void()> in_the_frame = [] {};

/// A method that shares tasks, as the stages do.
class TestedPoses : public PoseSource {
 public:
  TestedPoses(const Rig& rig, const Scene& scene)
      : source_(Registry<PoseSource>::get("marker")(rig, scene)) {}
  bool needs_markers() const override { return source_->needs_markers(); }
  void estimate(const FrameSet& frame, const Markers& markers, Poses& poses) override {
    in_the_frame();
    source_->estimate(frame, markers, poses);
  }

 private:
  std::unique_ptr<PoseSource> source_;
};
const bool isolation_test_registered = Registry<PoseSource>::add(
    "isolation_test",
    [](const Rig& rig, const Scene& scene) { return std::make_unique<TestedPoses>(rig, scene); });

/// Waits for something that others do; false if they do not.
template <class Is>
bool wait_until(const Is& is) {
  const auto end = std::chrono::steady_clock::now() + 5s;
  while (!is()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

// A frame's thread waits for one of its tasks, which another thread has, while tasks that are not
// the frame's lie in the same arena, to be taken.
TEST(Isolation, AThreadThatWaitsInAFrameBeginsNothingElse) {
  testing::FirstFrame first("calendar");
  first.options.memory = "off";
  oneapi::tbb::task_arena arena(3, 2);
  static thread_local bool is_in_frame = false;
  std::atomic<int> begun = 0;
  std::atomic<bool> is_shared = true;
  std::atomic<bool> waits = false;
  std::atomic<bool> is_offered = false;
  std::atomic<int> begun_in_the_frame = 0;
  in_the_frame = [&] {
    const std::thread::id own = std::this_thread::get_id();
    for_tasks(2, [&](std::size_t) {
      ++begun;
      if (!wait_until([&] { return begun == 2; })) is_shared = false;
      if (std::this_thread::get_id() == own) return;
      waits = true;
      if (is_shared) wait_until([&] { return is_offered.load(); });
    });
    waits = true;
  };
  std::jthread others([&] {
    if (!wait_until([&] { return waits.load(); })) return;
    arena.execute([&] {
      oneapi::tbb::parallel_for(
          0, 50,
          [&](int) {
            if (is_in_frame) ++begun_in_the_frame;
            std::this_thread::sleep_for(2ms);
          },
          oneapi::tbb::simple_partitioner());
    });
    is_offered = true;
  });
  arena.execute([&] {
    Rig rig = first.rig();
    rig.pose_source = "isolation_test";
    Pipeline pipeline(rig, first.recording.scene, first.options);
    is_in_frame = true;
    pipeline.process(first.frame, first.result);
    is_in_frame = false;
  });
  others.join();
  in_the_frame = [] {};
  if (!is_shared) GTEST_SKIP() << "one thread only";
  EXPECT_EQ(begun, 2);
  EXPECT_EQ(begun_in_the_frame, 0);
}

}  // namespace
}  // namespace diminish
