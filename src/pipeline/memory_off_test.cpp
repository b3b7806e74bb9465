#include <gtest/gtest.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "paths.h"

namespace diminish {
namespace {

/// What is made of frames, by their index, if they come in this order.
std::vector<DiminishedFrame> in_order(const Recording& recording, const Options& options,
                                      std::vector<FrameSet>& frames,
                                      const std::vector<std::size_t>& order) {
  Pipeline pipeline(recording.rig, recording.scene, options);
  std::vector<DiminishedFrame> results(frames.size());
  for (const std::size_t i : order) pipeline.process(frames[i], results[i]);
  return results;
}

bool is_same(const DiminishedFrame& a, const DiminishedFrame& b) {
  return a.picture == b.picture && a.mask == b.mask && a.provenance == b.provenance;
}

// The memory off: no frame depends on another one. On, they do, or this would show nothing.
TEST(MemoryOff, LeavesEveryFrameAlone) {
  const Recording recording =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "ball");
  Options options;
  options.memory = "off";
  const auto source = open_recording(recording, options);
  std::vector<FrameSet> frames;
  for (FrameSet frame; source->next(frame); frame = {}) frames.push_back(std::move(frame));
  ASSERT_EQ(frames.size(), 3U);
  const std::vector<DiminishedFrame> expected = in_order(recording, options, frames, {0, 1, 2});
  for (const std::vector<std::size_t>& order :
       {std::vector<std::size_t>{2, 1, 0}, {0, 1, 0, 2}, {0}, {1}, {2}}) {
    const std::vector<DiminishedFrame> results = in_order(recording, options, frames, order);
    for (const std::size_t i : order) {
      ASSERT_GT(results[i].report.valid_pixels, 1000U);
      EXPECT_TRUE(is_same(results[i], expected[i])) << i;
    }
  }
  options.memory = "on";
  EXPECT_FALSE(is_same(in_order(recording, options, frames, {0, 1, 2})[2],
                       in_order(recording, options, frames, {2})[2]));
}

}  // namespace
}  // namespace diminish
