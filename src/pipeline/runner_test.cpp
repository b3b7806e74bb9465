#include "diminish/runner.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <set>

#include "diminish/error.h"
#include "diminish/occluder_settings.h"
#include "onnx_model.h"
#include "paths.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using testing::recordings;

/// Keeps what it is given.
class MemorySink : public FrameSink {
 public:
  void write_images(const FrameSet&, const DiminishedFrame& result) override {
    const std::lock_guard lock(mutex_);
    written.insert(result.name);
  }
  void append(const FrameSet& frame, const DiminishedFrame& result) override {
    EXPECT_TRUE(written.count(result.name)) << "append before write_images";
    EXPECT_EQ(frame.name, result.name);
    names.push_back(result.name);
    pictures.push_back(result.picture);
    provenances.push_back(result.provenance);
    masks.push_back(result.mask);
    reconstructions.push_back(result.reconstruction.color);
  }

  std::set<std::string> written;
  std::vector<std::string> names;
  std::vector<Image<Bgr>> pictures;
  std::vector<Image<std::uint8_t>> provenances;
  std::vector<Mask> masks;
  std::vector<Image<Bgra>> reconstructions;

 private:
  std::mutex mutex_;
};

class Runner : public ::testing::Test {
 protected:
  std::size_t run_with(FrameSink& sink, const RunnerOptions& options) {
    const auto source = open_recording(recording, {});
    return run(*source, recording.rig, recording.scene, frame_options, sink, options);
  }

  Options frame_options;
  Recording recording = load_recording(recordings / "workbench");
};

TEST_F(Runner, TheSameBytesWhateverTheNumberOfThreads) {
  MemorySink one;
  MemorySink two;
  EXPECT_EQ(run_with(one, {.threads = 1}), run_with(two, {.threads = 2}));
  ASSERT_GE(one.names.size(), 3U);
  EXPECT_EQ(one.names, two.names);
  EXPECT_TRUE(std::is_sorted(two.names.begin(), two.names.end()));
  for (std::size_t i = 0; i < one.names.size(); ++i) {
    EXPECT_EQ(one.pictures[i], two.pictures[i]);
    EXPECT_EQ(one.provenances[i], two.provenances[i]);
    EXPECT_EQ(one.reconstructions[i], two.reconstructions[i]);
  }
}

// What a frame is reminded of, the frames before it have learnt, whichever pipeline they were in.
TEST_F(Runner, RemembersTheSameWhateverTheNumberOfThreads) {
  namespace tbb = oneapi::tbb;
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  const Recording ball = load_recording(recordings / "ball");
  Options options;
  options.memory = "on";
  MemorySink expected;
  for (const int threads : {1, 2, 3, 8}) {
    MemorySink sink;
    const auto source = open_recording(ball, options);
    run(*source, ball.rig, ball.scene, options, sink, {.threads = threads});
    if (threads == 1) {
      expected.pictures = sink.pictures;
      expected.provenances = sink.provenances;
      ASSERT_GE(expected.pictures.size(), 3U);
      const Image<std::uint8_t>& last = expected.provenances.back();
      EXPECT_GT(count_equal(last, provenance::witnessed, last.bounds()), 1000U);
    }
    EXPECT_EQ(sink.pictures, expected.pictures) << threads;
    EXPECT_EQ(sink.provenances, expected.provenances) << threads;
  }
}

// So are the answers of a network that looks at every second picture only.
TEST_F(Runner, CarriesANetworksAnswersTheSameWhateverTheNumberOfThreads) {
  const TemporaryFolder folder;
  testing::OnnxModel::write(folder.path() / "m.onnx", {{-1, 0.5F, 0.5F}}, {0}, 160, 96);
  const auto settings = std::make_shared<OnnxSettings>();
  settings->model = folder.path() / "m.onnx";
  settings->width = 160;
  settings->height = 96;
  settings->threshold = 0.1;
  settings->every = 2;
  settings->steady = 0.3;
  Recording calendar = load_recording(recordings / "calendar");
  calendar.scene.occluders = {{.name = "blue", .detector = "onnx", .settings = settings}};
  MemorySink expected;
  for (const int threads : {1, 3}) {
    MemorySink sink;
    const auto source = open_recording(calendar, {});
    run(*source, calendar.rig, calendar.scene, {}, sink, {.threads = threads});
    if (threads == 1) {
      expected.masks = sink.masks;
      expected.pictures = sink.pictures;
      ASSERT_EQ(expected.masks.size(), 5U);
      EXPECT_GT(count_equal(expected.masks[4], 255, expected.masks[4].bounds()), 100U);
      EXPECT_NE(expected.masks[4], expected.masks[2]);
    }
    EXPECT_EQ(sink.masks, expected.masks) << threads;
    EXPECT_EQ(sink.pictures, expected.pictures) << threads;
  }
}

TEST_F(Runner, StopsAfterTheFramesInWorkAndReportsProgress) {
  std::atomic<bool> stop = false;
  MemorySink sink;
  std::vector<std::size_t> progress;
  RunnerOptions options{.threads = 1, .stop = &stop};
  options.progress = [&](std::size_t done) {
    progress.push_back(done);
    stop = true;
  };
  EXPECT_EQ(run_with(sink, options), 1U);
  EXPECT_EQ(progress, std::vector<std::size_t>{1});
}

// Whichever frame fails, those before it are delivered and none after it.
TEST_F(Runner, FramesBeforeAnErrorAreDelivered) {
  class FullDisk : public MemorySink {
    void write_images(const FrameSet& frame, const DiminishedFrame& result) override {
      if (frame.name == "000001") throw Error("result/000001.png: cannot be written");
      MemorySink::write_images(frame, result);
    }
  };
  class TornStream : public FrameSource {
   public:
    explicit TornStream(std::unique_ptr<FrameSource> whole) : whole_(std::move(whole)) {}
    bool next(FrameSet& frame) override {
      if (++frames_ == 3) throw Error("color: cannot be read");
      return whole_->next(frame);
    }

   private:
    std::unique_ptr<FrameSource> whole_;
    int frames_ = 0;
  };
  class TornImage : public FrameSource {
   public:
    explicit TornImage(std::unique_ptr<FrameSource> whole) : whole_(std::move(whole)) {}
    bool next(FrameSet& frame) override { return whole_->next(frame); }
    void read_images(FrameSet& frame) override {
      if (frame.index == 1) throw Error("color: no memory");
    }

   private:
    std::unique_ptr<FrameSource> whole_;
  };
  // What frames show does not matter here.
  frame_options.complete_sides = frame_options.draw_bars = frame_options.refine_poses = false;
  for (const int threads : {1, 2, 3}) {
    FullDisk disk;
    EXPECT_THROW(run_with(disk, {.threads = threads}), Error);
    EXPECT_EQ(disk.names, std::vector<std::string>{"000000"});
    MemorySink sink;
    TornStream torn(open_recording(recording, {}));
    EXPECT_THROW(
        run(torn, recording.rig, recording.scene, frame_options, sink, {.threads = threads}),
        Error);
    EXPECT_EQ(sink.names, (std::vector<std::string>{"000000", "000001"}));
    MemorySink first_only;
    TornImage image(open_recording(recording, {}));
    EXPECT_THROW(
        run(image, recording.rig, recording.scene, frame_options, first_only, {.threads = threads}),
        Error);
    EXPECT_EQ(first_only.names, std::vector<std::string>{"000000"});
  }
}

TEST_F(Runner, ReadsSeveralFramesAtATimeButNoMoreThanThreads) {
  // Each frame waits in `read_images` until as many are there as threads.
  class Watched : public FrameSource {
   public:
    Watched(std::unique_ptr<FrameSource> whole, int threads)
        : whole_(std::move(whole)), threads_(threads) {}
    bool next(FrameSet& frame) override { return whole_->next(frame); }
    bool begin(FrameSet& frame) override {
      if (!whole_->begin(frame)) return false;
      ++begun;
      most_begun = std::max(most_begun, begun - done);
      return true;
    }
    void read_images(FrameSet& frame) override {
      whole_->read_images(frame);
      std::unique_lock lock(mutex_);
      ++reading_;
      changed_.notify_all();
      together = together && changed_.wait_for(lock, std::chrono::seconds(60),
                                               [&] { return reading_ >= threads_; });
    }

    int begun = 0, done = 0, most_begun = 0;
    bool together = true;

   private:
    std::unique_ptr<FrameSource> whole_;
    int threads_;
    std::mutex mutex_;
    std::condition_variable changed_;
    int reading_ = 0;
  };
  const oneapi::tbb::global_control as_many_threads(
      oneapi::tbb::global_control::max_allowed_parallelism, 3);
  for (const int threads : {1, 2, 3}) {
    Watched source(open_recording(recording, {}), threads);
    MemorySink sink;
    RunnerOptions options{.threads = threads};
    options.progress = [&](std::size_t) { ++source.done; };
    EXPECT_EQ(run(source, recording.rig, recording.scene, {}, sink, options), 3U);
    EXPECT_TRUE(source.together);
    EXPECT_LE(source.most_begun, threads);
  }
}

TEST_F(Runner, AnErrorInTheSinkReachesTheCaller) {
  class FullDisk : public FrameSink {
    void write_images(const FrameSet&, const DiminishedFrame&) override {
      throw Error("result/000000.png: cannot be written");
    }
    void append(const FrameSet&, const DiminishedFrame&) override {}
  } sink;
  EXPECT_THROW(run_with(sink, {.threads = 2}), Error);
}

}  // namespace
}  // namespace diminish
