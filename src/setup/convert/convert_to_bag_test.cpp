#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <sstream>

#include "diminish/frame_source.h"
#include "expect_error.h"
#include "paths.h"
#include "setup/convert/convert.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

std::filesystem::path original() {
  return std::filesystem::path(testing::recordings_dir()) / "calendar";
}

/// Makes a recording of a bag of `original()`, whose reader knows nothing of its writer.
void expect_original(const std::filesystem::path& bag, const std::filesystem::path& made) {
  BagChoice choice;
  choice.color = "/color/image_raw/compressed";
  const Conversion back = convert_bag(bag, made, choice);
  EXPECT_EQ(back.left_out, 0U);
  const Recording before = load_recording(original());
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
}

std::size_t images_of(const Conversion& conversion) {
  std::size_t images = 0;
  for (const auto& stream : conversion.streams) images += stream.images;
  return images;
}

#ifdef DIMINISH_HAS_SQLITE
TEST(ConvertToBag, ARecordingComesBackFromItsBag) {
  const TemporaryFolder folder;
  const auto bag = folder.path() / "bag";
  const std::size_t images = images_of(convert_to_bag(original(), bag));
  const YAML::Node metadata =
      YAML::LoadFile((bag / "metadata.yaml").string())["rosbag2_bagfile_information"];
  // Each image has a camera_info; and there is a message of transforms.
  EXPECT_EQ(metadata["message_count"].as<std::size_t>(), 2 * images + 1);
  EXPECT_EQ(metadata["relative_file_paths"][0].as<std::string>(), "bag_0.db3");
  expect_original(bag, folder.path() / "made");
  EXPECT_THAT(error_of([&] { convert_to_bag(original(), bag); }),
              HasSubstr("that is not there yet"));
}
#endif

TEST(ConvertToBag, ARecordingComesBackFromItsMcapFile) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.mcap";
  const std::size_t images = images_of(convert_to_bag(original(), file));
  expect_original(file, folder.path() / "made");
  EXPECT_THAT(error_of([&] { convert_to_bag(original(), file); }),
              HasSubstr("a.mcap: expected a file that is not there yet"));
  // The footer (op 2, 20 bytes, then the magic) says where the summary begins; there are schemas,
  // channels and the number of messages (op 11).
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  const std::string bytes = text.str();
  const auto number = [&](std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = 8; i-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  const std::size_t footer = bytes.size() - 8 - 20 - 9;
  ASSERT_EQ(bytes[footer], 2);
  bool has_statistics = false;
  for (std::size_t at = number(footer + 9); at < footer; at += 9 + number(at + 1)) {
    if (bytes[at] != 11) continue;
    has_statistics = true;
    EXPECT_EQ(number(at + 9), 2 * images + 1);
  }
  EXPECT_TRUE(has_statistics);
}

}  // namespace
}  // namespace diminish
