#include "diminish/live.h"

#include <gmock/gmock.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "diminish/reconstructor.h"
#include "diminish/registry.h"
#include "expect_error.h"
#include "paths.h"
#include "same_pixels.h"

namespace diminish {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

using testing::recordings;

/// Waits until `is_true`, for a generous time, because test machines may be slow.
template <class Condition>
bool eventually(Condition&& is_true) {
  for (int i = 0; i < 3000; ++i) {
    if (is_true()) return true;
    std::this_thread::sleep_for(milliseconds(10));
  }
  return false;
}

class Live : public ::testing::Test {
 protected:
  std::vector<LiveCamera> cameras(const std::string& color_prefix = "",
                                  const std::string& rgbd_prefix = "",
                                  const std::string& parameters = "?loop") const {
    const std::string replay = "recording:" + recording_.folder.string() + parameters;
    return {{"color", color_prefix + replay}, {"rgbd0", rgbd_prefix + replay}};
  }
  std::unique_ptr<LiveSession> start(const std::vector<LiveCamera>& cameras,
                                     const LiveOptions& live_options = {}) const {
    return std::make_unique<LiveSession>(recording_.rig, recording_.scene, options_, cameras,
                                         live_options);
  }

  Recording recording_ = load_recording(recordings / "calendar");
  Options options_;
};

TEST_F(Live, ShowsWhatThePipelineMakesOfTheRecordingsFrames) {
  std::vector<FrameSet> recorded;
  const auto source = open_recording(recording_, options_);
  for (FrameSet frame; source->next(frame);) recorded.push_back(frame);

  options_.memory = "off";           // which would need every frame in between
  options_.sync_tolerance_s = 0.01;  // also when the machine is so slow that images are left out
  const auto session = start(cameras());
  Pipeline pipeline(recording_.rig, recording_.scene, options_);
  DiminishedFrame expected;
  std::size_t number = 0;
  for (int i = 0; i < 5;) {
    const auto frame = session->wait_for_frame(number, seconds(30));
    ASSERT_TRUE(frame);
    EXPECT_GT(frame->number, number);
    number = frame->number;
    // Its camera may open later than the user's.
    if (!frame->input.rgbd[0].available()) continue;
    ++i;
    // The picture tells which of the recording's frames it is.
    const auto same = std::find_if(recorded.begin(), recorded.end(), [&](const FrameSet& r) {
      return testing::same_pixels(r.color, frame->input.color);
    });
    ASSERT_NE(same, recorded.end());
    EXPECT_TRUE(testing::same_pixels(frame->input.rgbd[0].depth, same->rgbd[0].depth));
    EXPECT_TRUE(testing::same_pixels(frame->input.rgbd[0].color, same->rgbd[0].color));
    pipeline.process(*same, expected);
    EXPECT_EQ(frame->result.picture, expected.picture);
    EXPECT_GT(frame->latency_ms, 0);
  }
  EXPECT_TRUE(eventually([&] { return session->status().problems.empty(); }));
  const LiveStatus status = session->status();
  EXPECT_EQ(status.cameras.size(), 2U);
  for (const CameraStatus& camera : status.cameras) {
    EXPECT_EQ(camera.state, CameraState::running);
    EXPECT_GE(camera.images, 5U);
  }
  EXPECT_GT(status.frame_ms, 0);
  EXPECT_GE(status.latency_ms.p99, status.latency_ms.p50);
}

// What is remembered depends on every frame before.
TEST_F(Live, FramesInFlightMakeWhatOnePipelineMakes) {
  LiveOptions live_options;
  live_options.threads = 2;
  live_options.frames_in_flight = 3;
  std::mutex mutex;
  std::vector<std::shared_ptr<const LiveFrame>> frames;
  // Again where the first frame was there before the listener.
  while (frames.empty() || frames.front()->number != 1) {
    frames.clear();
    const auto session = start(cameras(), live_options);
    const auto listener = session->on_frame([&](const auto& frame) {
      const std::lock_guard lock(mutex);
      frames.push_back(frame);
    });
    ASSERT_TRUE(eventually([&] {
      const std::lock_guard lock(mutex);
      return frames.size() >= 12;
    }));
    session->stop();
  }

  Pipeline pipeline(recording_.rig, recording_.scene, options_);
  DiminishedFrame expected;
  double stamp_s = -1;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    SCOPED_TRACE(i);
    const LiveFrame& frame = *frames[i];
    EXPECT_EQ(frame.number, i + 1);
    EXPECT_GT(frame.input.stamp_s, stamp_s);
    stamp_s = frame.input.stamp_s;
    pipeline.process(frame.input, expected);
    EXPECT_EQ(frame.result.picture, expected.picture);
    EXPECT_EQ(frame.result.provenance, expected.provenance);
  }
}

TEST_F(Live, StopsFromItsOwnCallAndFromSeveralThreads) {
  const auto session = start(cameras());
  std::atomic<int> calls = 0;
  std::shared_ptr<void> stopping = session->on_frame([&](const auto&) {
    ++calls;
    stopping.reset();
    session->stop();
  });
  EXPECT_TRUE(eventually([&] { return calls > 0; }));
  std::thread other([&] { session->stop(); });
  session->stop();
  other.join();
  EXPECT_EQ(calls, 1);
  EXPECT_FALSE(session->status().running);
}

TEST_F(Live, MayBeDestroyedWithinItsOwnCall) {
  const auto held = std::make_shared<int>(1);
  auto session = start(cameras());
  std::atomic<bool> is_destroyed = false;
  auto listener = session->on_frame([&, held](const auto&) {
    session.reset();
    is_destroyed = true;
  });
  ASSERT_TRUE(eventually([&] { return is_destroyed.load(); }));
  listener.reset();
  EXPECT_TRUE(eventually([&] { return held.use_count() == 1; })) << "its threads have ended";
}

/// As slow to set up as a GPU whose shaders are compiled: it waits until it may end.
struct SlowBackend : Reconstructor {
  static inline std::atomic<bool> is_being_made = false, may_end = false, was_made = false;

  SlowBackend() {
    is_being_made = true;
    for (int i = 0; i < 1000 && !may_end; ++i) std::this_thread::sleep_for(milliseconds(10));
    was_made = true;
  }
  void reconstruct(const FrameSet&, const DepthImages&, const Poses&, const OcclusionMasks&,
                   const TiledRegion&, const Options&, Reconstruction&) override {
    throw Error("only slow");
  }
};

TEST_F(Live, WhileOptionsTakeEffectTheStatusIsNotWaitedFor) {
  Registry<Reconstructor>::add("slow", [](const Rig&) { return std::make_unique<SlowBackend>(); });
  const auto session = start(cameras());
  ASSERT_TRUE(session->wait_for_frame(0, seconds(30)));
  options_.backend = "slow";
  session->set_options(options_);
  ASSERT_TRUE(eventually([] { return SlowBackend::is_being_made.load(); }));
  EXPECT_TRUE(session->status().running);
  EXPECT_EQ(session->options().backend, "slow");
  EXPECT_FALSE(SlowBackend::was_made);
  SlowBackend::may_end = true;
  const std::size_t shown = session->status().frames;
  EXPECT_TRUE(session->wait_for_frame(shown, seconds(30))) << "drawn by the CPU";
}

TEST_F(Live, ARemovedCallDoesNotRunAnyMore) {
  const auto session = start(cameras());
  std::atomic<bool> is_there = true, ran = false, ran_after = false;
  auto listener = session->on_frame([&](const auto&) {
    ran = true;
    std::this_thread::sleep_for(milliseconds(50));
    if (!is_there) ran_after = true;
  });
  EXPECT_TRUE(eventually([&] { return ran.load(); }));
  listener.reset();
  is_there = false;
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_FALSE(ran_after);
}

TEST_F(Live, SaysWhereAFrameIsStuck) {
  const auto session = start(cameras());
  std::atomic<bool> may_end = false;
  const auto listener = session->on_frame([&may_end](const auto&) {
    while (!may_end) std::this_thread::sleep_for(milliseconds(1));
  });
  const auto problems = [&] { return session->status().problems; };
  const auto is_stuck = Contains(AllOf(HasSubstr("a frame takes"), HasSubstr("in stage: none")));
  EXPECT_TRUE(eventually([&] { return ::testing::Value(problems(), is_stuck); }));
  may_end = true;
  EXPECT_TRUE(eventually([&] { return !::testing::Value(problems(), is_stuck); }));
}

TEST_F(Live, SettingsTakeEffectAndWrongOnesChangeNothing) {
  const auto session = start(cameras());
  ASSERT_TRUE(session->wait_for_frame(0, seconds(30)));
  EXPECT_GT(session->status().mask_share, 0);

  Options changed = session->options();
  changed.keep = "calendar";
  session->set_options(changed);
  EXPECT_TRUE(eventually([&] { return session->status().mask_share == 0; }));
  EXPECT_TRUE(session->status().occluders.at(0).kept);

  changed.keep = "teapot";
  EXPECT_THAT(error_of([&] { session->set_options(changed); }),
              AllOf(HasSubstr("keep"), HasSubstr("'teapot'"), HasSubstr("calendar")));
  EXPECT_EQ(session->options().keep, "calendar");
}

TEST_F(Live, FaultsAreBorneAndCounted) {
  const std::string faults =
      "faults:seed=3&drop=0.05&duplicate=0.1&disorder=0.1&wrong_size=0.1&torn=0.1&stall=0.02&"
      "stall_s=1.1&unplug=0.01;";
  const auto session = start(cameras(faults, faults));
  const auto both = [&](auto member) {
    std::size_t sum = 0;
    for (const CameraStatus& camera : session->status().cameras) sum += camera.*member;
    return sum;
  };
  EXPECT_TRUE(eventually([&] {
    return both(&CameraStatus::duplicates) > 0 && both(&CameraStatus::out_of_order) > 0 &&
           both(&CameraStatus::wrong_size) > 0 && both(&CameraStatus::damaged) > 0 &&
           both(&CameraStatus::dropped) > 0 && both(&CameraStatus::stalls) > 0 &&
           both(&CameraStatus::failures) > 0 && both(&CameraStatus::reconnects) > 0;
  }));
  // And it goes on.
  const std::size_t before = session->status().frames;
  EXPECT_GT(before, 0U);
  EXPECT_TRUE(eventually([&] { return session->status().frames > before + 3; }));
  EXPECT_EQ(session->status().failed, 0U);
}

TEST_F(Live, ACameraThatIsNotThereIsSaidAndTheRestGoesOn) {
  auto missing = cameras();
  missing[1].uri = "recording:/nowhere";
  const auto session = start(missing);
  const auto frame = session->wait_for_frame(0, seconds(30));
  ASSERT_TRUE(frame);
  EXPECT_FALSE(frame->input.rgbd[0].available());
  EXPECT_THAT(session->status().problems,
              Contains(AllOf(HasSubstr("rgbd0: camera lost"), HasSubstr("/nowhere/rig.yaml"))));
  EXPECT_TRUE(eventually([&] { return session->status().cameras[1].failures >= 2; }))
      << "it tries again";
}

TEST_F(Live, WithoutTheUsersCameraItSaysSo) {
  auto missing = cameras();
  missing[0].uri = "recording:/nowhere";
  const auto session = start(missing);
  EXPECT_EQ(session->wait_for_frame(0, milliseconds(300)), nullptr);
  EXPECT_THAT(session->status().problems,
              AllOf(Contains(HasSubstr("color: camera lost")), Contains("no new picture")));
}

TEST_F(Live, ARecordingThatIsNotLoopedEnds) {
  const auto session = start(cameras("", "", ""));
  EXPECT_TRUE(eventually([&] { return session->status().ended; }));
  EXPECT_GT(session->status().frames, 0U);
}

TEST_F(Live, ListenersGetEachFrameInOrderUntilTheyLeave) {
  const auto session = start(cameras());
  std::vector<std::size_t> numbers;
  std::atomic<std::size_t> count = 0;
  auto listener = session->on_frame([&](const auto& frame) {
    numbers.push_back(frame->number);
    ++count;
  });
  ASSERT_TRUE(eventually([&] { return count >= 5; }));
  listener.reset();
  const std::size_t shown = session->status().frames;
  ASSERT_TRUE(eventually([&] { return session->status().frames > shown + 2; }));
  session->stop();
  for (std::size_t i = 1; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], numbers[i - 1] + 1);
  EXPECT_LE(numbers.back(), shown + 1);
}

TEST_F(Live, ABudgetThatCannotBeKeptStepsQualityDown) {
  const auto session = start(cameras(), {.budget_ms = 0.01});
  EXPECT_TRUE(eventually([&] { return session->status().quality_level > 2; }));
  EXPECT_THAT(session->status().quality, HasSubstr("simpler colours"));
  session->set_budget_ms(0);
  EXPECT_TRUE(eventually([&] { return session->status().quality_level == 0; }));
}

TEST_F(Live, ConfigurationsThatCannotWorkAreRefused) {
  auto wrong = cameras();
  wrong[1].name = "rgbd9";
  EXPECT_THAT(error_of([&] { start(wrong); }), HasSubstr("rgbd9: the rig has no camera"));
  wrong = cameras();
  wrong.pop_back();
  EXPECT_THAT(error_of([&] { start(wrong); }), HasSubstr("rgbd0: expected a camera"));
  wrong = cameras();
  wrong.erase(wrong.begin());
  EXPECT_THAT(error_of([&] { start(wrong); }), HasSubstr("color: expected a camera"));
  wrong = cameras();
  wrong[0].uri = "telepathy:x";
  EXPECT_THAT(error_of([&] { start(wrong); }), HasSubstr("unknown kind of camera 'telepathy'"));
  options_.mask_margin_px = -1;
  EXPECT_THAT(error_of([&] { start(cameras()); }), HasSubstr("mask_margin_px"));
}

}  // namespace
}  // namespace diminish
