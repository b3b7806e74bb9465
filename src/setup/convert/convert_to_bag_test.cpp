#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include "diminish/frame_source.h"
#include "expect_error.h"
#include "paths.h"
#include "setup/convert/convert.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

// There and back: the bag's own reader knows nothing of its writer.
TEST(ConvertToBag, ARecordingComesBackFromItsBag) {
  const auto original = std::filesystem::path(testing::recordings_dir()) / "calendar";
  const TemporaryFolder folder;
  const auto bag = folder.path() / "bag";
  const Conversion there = convert_to_bag(original, bag);
  const YAML::Node metadata =
      YAML::LoadFile((bag / "metadata.yaml").string())["rosbag2_bagfile_information"];
  std::size_t images = 0;
  for (const auto& stream : there.streams) images += stream.images;
  // Each image has a camera_info; and there is a message of transforms.
  EXPECT_EQ(metadata["message_count"].as<std::size_t>(), 2 * images + 1);
  EXPECT_EQ(metadata["relative_file_paths"][0].as<std::string>(), "bag_0.db3");

  BagChoice choice;
  choice.color = "/color/image_raw/compressed";
  const auto made = folder.path() / "made";
  const Conversion back = convert_bag(bag, made, choice);
  EXPECT_EQ(back.left_out, 0U);
  const Recording before = load_recording(original);
  const Recording after = load_recording(made);
  EXPECT_NEAR(after.rig.color.fx, before.rig.color.fx, 1e-3);
  EXPECT_TRUE(after.rig.rgbd[0].color_from_depth.rotation.isApprox(
      before.rig.rgbd[0].color_from_depth.rotation, 1e-6));
  const auto source = open_recording(before, {});
  const auto converted = open_recording(after, {});
  FrameSet expected, got;
  int frames = 0;
  for (; source->next(expected); ++frames) {
    ASSERT_TRUE(converted->next(got));
    EXPECT_EQ(got.color.own(), expected.color.own());
    EXPECT_EQ(got.rgbd[0].color.own(), expected.rgbd[0].color.own());
    EXPECT_EQ(got.rgbd[0].depth.own(), expected.rgbd[0].depth.own());
    EXPECT_NEAR(got.stamp_s, expected.stamp_s, 2e-6);
  }
  EXPECT_GT(frames, 0);
  EXPECT_FALSE(converted->next(got));
  EXPECT_THAT(error_of([&] { convert_to_bag(original, bag); }), HasSubstr("that is not there yet"));
}

}  // namespace
}  // namespace diminish
