#include "diminish/recording_writer.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "core/text.h"
#include "diminish/frame_source.h"
#include "diminish/pose_source.h"
#include "expect_error.h"
#include "geometry/rotation.h"
#include "paths.h"
#include "same_pixels.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

using testing::recordings;

std::vector<FrameSet> frames_of(const std::filesystem::path& folder) {
  const Recording recording = load_recording(folder);
  const auto source = open_recording(recording, {});
  std::vector<FrameSet> frames;
  for (FrameSet frame; source->next(frame);) frames.push_back(frame);
  return frames;
}

double mean_difference(ImageView<Bgr> a, ImageView<Bgr> b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      sum += std::abs(a(x, y).b - b(x, y).b) + std::abs(a(x, y).g - b(x, y).g) +
             std::abs(a(x, y).r - b(x, y).r);
    }
  }
  return sum / (3.0 * a.width() * a.height());
}

class Writer : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<RecordingWriter> write_to(const std::filesystem::path& folder) const {
    return std::make_unique<RecordingWriter>(folder, source_ / "rig.yaml", recording_.rig,
                                             source_ / "scene.yaml", recording_.scene);
  }

  /// No frame comes before the last one is written, so that none is dropped, however slow the disk.
  static void offer_and_wait(RecordingWriter& writer, const std::shared_ptr<LiveFrame>& frame) {
    const std::size_t before = writer.status().frames;
    writer.offer(frame);
    while (writer.status().frames == before && writer.status().problem.empty()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  std::filesystem::path source_ = recordings / GetParam();
  Recording recording_ = load_recording(source_);
  TemporaryFolder folder_;
};

TEST_P(Writer, WhatIsWrittenIsReadAgain) {
  const std::vector<FrameSet> original = frames_of(source_);
  const auto copy = folder_.path() / "copy";
  {
    const auto writer = write_to(copy);
    for (const FrameSet& frame : original) {
      auto live = std::make_shared<LiveFrame>();
      live->input = frame;
      offer_and_wait(*writer, live);
      writer->offer(live);  // the same frame again is none
    }
    writer->finish();
    EXPECT_EQ(writer->status().problem, "");
    EXPECT_EQ(writer->status().frames, original.size());
  }
  const std::vector<FrameSet> read = frames_of(copy);  // with what scene.yaml names
  ASSERT_EQ(read.size(), original.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].stamp_s, original[i].stamp_s, 1e-6);
    EXPECT_LT(mean_difference(read[i].color, original[i].color), 2);
    for (std::size_t k = 0; k < read[i].rgbd.size(); ++k) {
      EXPECT_TRUE(testing::same_pixels(read[i].rgbd[k].depth, original[i].rgbd[k].depth))
          << "depth loses nothing";
      EXPECT_LT(mean_difference(read[i].rgbd[k].color, original[i].rgbd[k].color), 2);
    }
  }
}

TEST_P(Writer, NothingIsLostWhenTheClockIsSetBack) {
  const std::vector<FrameSet> original = frames_of(source_);
  const auto copy = folder_.path() / "copy";
  {
    const auto writer = write_to(copy);
    for (const double back_s : {0., 100., 40.}) {
      for (const FrameSet& frame : original) {
        auto live = std::make_shared<LiveFrame>();
        live->input = frame;
        live->input.stamp_s -= back_s;
        for (RgbdFrame& rgbd : live->input.rgbd) {
          rgbd.color_stamp_s -= back_s;
          rgbd.depth_stamp_s -= back_s;
        }
        offer_and_wait(*writer, live);
      }
    }
  }
  const std::vector<FrameSet> read = frames_of(copy);
  ASSERT_EQ(read.size(), 3 * original.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    const FrameSet& expected = original[i % original.size()];
    EXPECT_LT(mean_difference(read[i].color, expected.color), 2);
    for (std::size_t k = 0; k < read[i].rgbd.size(); ++k) {
      EXPECT_TRUE(testing::same_pixels(read[i].rgbd[k].depth, expected.rgbd[k].depth));
      EXPECT_NEAR(read[i].rgbd[k].depth_stamp_s - read[i].stamp_s,
                  expected.rgbd[k].depth_stamp_s - expected.stamp_s, 1e-5);
    }
  }
}

TEST_P(Writer, WhatNoRgbdCameraSawIsARecordingToo) {
  auto live = std::make_shared<LiveFrame>();
  live->input = frames_of(source_).front();
  for (RgbdFrame& rgbd : live->input.rgbd) rgbd.missing = "not connected";
  const auto copy = folder_.path() / "copy";
  const auto writer = write_to(copy);
  writer->offer(live);
  writer->finish();
  const std::vector<FrameSet> read = frames_of(copy);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_LT(mean_difference(read[0].color, live->input.color), 2);
  for (const RgbdFrame& rgbd : read[0].rgbd) EXPECT_FALSE(rgbd.available());
}

INSTANTIATE_TEST_SUITE_P(Recordings, Writer, ::testing::Values("calendar", "ball", "workbench"));

class CalendarWriter : public Writer {};

TEST_P(CalendarWriter, CountsWhatItHasNoTimeFor) {
  const FrameSet first = frames_of(source_).front();
  const auto writer = write_to(folder_.path() / "copy");
  constexpr std::size_t offered = 100;
  for (std::size_t i = 0; i < offered; ++i) {
    auto live = std::make_shared<LiveFrame>();
    live->input = first;
    live->input.stamp_s += static_cast<double>(i);
    writer->offer(live);
  }
  writer->finish();
  EXPECT_EQ(writer->status().frames + writer->status().dropped, offered);
}

TEST_P(CalendarWriter, NothingThatIsThereIsLost) {
  folder_.write("copy/notes.txt", "mine");
  EXPECT_THAT(error_of([&] { write_to(folder_.path() / "copy"); }),
              HasSubstr("copy: expected an empty folder"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "copy" / "notes.txt"));
}

TEST_P(CalendarWriter, AFolderThatGoesAwayEndsItWithAReason) {
  auto live = std::make_shared<LiveFrame>();
  live->input = frames_of(source_).front();
  const auto copy = folder_.path() / "copy";
  const auto writer = write_to(copy);
  std::filesystem::remove_all(copy);
  writer->offer(live);
  writer->finish();
  EXPECT_FALSE(writer->status().active);
  EXPECT_THAT(writer->status().problem, HasSubstr("cannot be written"));
}

/// Turned and moved, by another amount for each camera and frame.
RigidTransform some_pose(std::size_t camera, std::size_t frame) {
  const double x = 0.1 * static_cast<double>(frame) + static_cast<double>(camera);
  return {rotation_by({0.3 * x, 0.1, -0.2 * x}), {x, 1 - x, 0.5}};
}

TEST_P(CalendarWriter, KeepsThePosesThatARobotTold) {
  std::string rig_yaml = read_text_file(source_ / "rig.yaml", 1 << 20);
  rig_yaml +=
      "pose:  # of a robot\n  source: tf\n  world: map\n"
      "  frames: {color: eye, rgbd0: camera}\n";
  folder_.write("rig.yaml", rig_yaml);
  recording_.rig.pose_source = "tf";
  const RigidTransform depth_from_posed{rotation_by({0, 0.2, 0}), {0.1, 0, 0}};
  recording_.rig.rgbd[0].depth_from_posed = depth_from_posed;
  const auto copy = folder_.path() / "copy";
  std::vector<FrameSet> original = frames_of(source_);
  {
    RecordingWriter writer(copy, folder_.path() / "rig.yaml", recording_.rig,
                           source_ / "scene.yaml", recording_.scene);
    for (std::size_t i = 0; i < original.size(); ++i) {
      auto live = std::make_shared<LiveFrame>();
      live->input = original[i];
      // In one frame no transform was there.
      live->result.report.poses.depth_from_world.resize(1);
      if (i != 1) {
        live->result.report.poses.color_from_world = some_pose(0, i);
        live->result.report.poses.depth_from_world[0] = depth_from_posed * some_pose(1, i);
      }
      offer_and_wait(writer, live);
    }
    EXPECT_EQ(writer.status().problem, "");
  }
  const Recording read = load_recording(copy);
  EXPECT_EQ(read.rig.pose_source, "file");
  const auto poses = Registry<PoseSource>::get("file")(read.rig, read.scene);
  const std::vector<FrameSet> frames = frames_of(copy);
  ASSERT_EQ(frames.size(), original.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Poses found;
    found.depth_from_world.resize(1);
    poses->estimate(frames[i], {}, found);
    ASSERT_EQ(found.color_from_world.has_value(), i != 1) << i;
    if (i == 1) continue;
    const auto expect_near = [&](const RigidTransform& a, const RigidTransform& b) {
      EXPECT_LT((a.rotation - b.rotation).norm() + (a.translation - b.translation).norm(), 1e-7);
    };
    expect_near(*found.color_from_world, some_pose(0, i));
    // The recording's rig.yaml is the one that was copied: without depth_from_posed.
    expect_near(*found.depth_from_world[0], some_pose(1, i));
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, CalendarWriter, ::testing::Values("calendar"));

}  // namespace
}  // namespace diminish
