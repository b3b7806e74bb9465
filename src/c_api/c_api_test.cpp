#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "diminish_c.h"
#include "paths.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

const std::string calendar = testing::recordings_dir() + "/calendar";

struct Close {
  void operator()(diminish_pipeline* pipeline) const { diminish_close(pipeline); }
};
using Owned = std::unique_ptr<diminish_pipeline, Close>;

Owned opened() {
  diminish_pipeline* pipeline = nullptr;
  EXPECT_EQ(diminish_open(calendar.c_str(), &pipeline), DIMINISH_OK) << diminish_last_error();
  EXPECT_EQ(diminish_set_option(pipeline, "memory", "off"), DIMINISH_OK) << diminish_last_error();
  return Owned(pipeline);
}

template <class Pixel>
bool equal(const Image<Pixel>& image, const diminish_image& other) {
  return image.width() == other.width && image.height() == other.height &&
         std::memcmp(image.data(), other.data, image.size() * sizeof(Pixel)) == 0;
}

template <class Pixel>
diminish_image image_of(const ImageView<Pixel>& view) {
  return {view.data(), view.width(), view.height(), view.stride()};
}

TEST(CApi, NamesTheCameras) {
  const Owned pipeline = opened();
  const Recording recording = load_recording(calendar);
  ASSERT_EQ(diminish_rgbd_count(pipeline.get()), recording.rig.rgbd.size());
  EXPECT_EQ(diminish_rgbd_name(pipeline.get(), 0), recording.rig.rgbd[0].name);
  EXPECT_EQ(diminish_rgbd_name(pipeline.get(), recording.rig.rgbd.size()), nullptr);
  EXPECT_EQ(diminish_rgbd_count(nullptr), 0);
}

/// The library in C++ is the reference.
TEST(CApi, GivesThePipelinesBytes) {
  const Recording recording = load_recording(calendar);
  Options options;
  options.memory = "off";
  Pipeline pipeline(recording.rig, recording.scene, options);
  const auto source = open_recording(recording, options);
  const Owned reading = opened();
  const Owned pushing = opened();
  FrameSet frame;
  DiminishedFrame expected;
  diminish_output output{};
  int more = 0;
  int frames = 0;
  for (; source->next(frame); ++frames) {
    pipeline.process(frame, expected);
    ASSERT_EQ(diminish_next(reading.get(), &output, &more), DIMINISH_OK) << diminish_last_error();
    ASSERT_EQ(more, 1);
    EXPECT_TRUE(equal(expected.picture, output.picture));
    EXPECT_TRUE(equal(expected.mask, output.mask));
    EXPECT_TRUE(equal(expected.provenance, output.provenance));
    EXPECT_EQ(output.mask_pixels, expected.report.mask_pixels);
    EXPECT_EQ(output.mask_pixels, output.seen_pixels + output.invented_pixels);
    EXPECT_STREQ(output.messages, "");

    const diminish_rgbd rgbd{image_of(frame.rgbd[0].color.view()),
                             image_of(frame.rgbd[0].depth.view())};
    const diminish_input input{image_of(frame.color.view()), &rgbd, 1, frame.stamp_s};
    ASSERT_EQ(diminish_process(pushing.get(), &input, &output), DIMINISH_OK)
        << diminish_last_error();
    EXPECT_TRUE(equal(expected.picture, output.picture));
  }
  EXPECT_GT(frames, 1);
  EXPECT_EQ(diminish_next(reading.get(), &output, &more), DIMINISH_OK);
  EXPECT_EQ(more, 0);
}

TEST(CApi, ACameraWithoutImagesIsAMessage) {
  const Owned pipeline = opened();
  const std::vector<std::uint8_t> grey(std::size_t{1280} * 1024 * 3, 120);
  const diminish_rgbd none{};
  const diminish_input input{{grey.data(), 1280, 1024, std::ptrdiff_t{1280} * 3}, &none, 1, 0};
  diminish_output output{};
  ASSERT_EQ(diminish_process(pipeline.get(), &input, &output), DIMINISH_OK);
  EXPECT_THAT(output.messages, HasSubstr("rgbd0: no images given\n"));
  EXPECT_EQ(std::memcmp(output.picture.data, grey.data(), grey.size()), 0);
}

TEST(CApi, ADetectorTakesTheObjectsPlace) {
  const Owned pipeline = opened();
  EXPECT_EQ(diminish_set_detector(pipeline.get(), "difference"), DIMINISH_OK);
  diminish_output output{};
  int more = 0;
  EXPECT_EQ(diminish_next(pipeline.get(), &output, &more), DIMINISH_OK);
  EXPECT_GT(output.mask_pixels, 10000U);
  EXPECT_EQ(diminish_set_detector(pipeline.get(), "nose"), DIMINISH_CONFIGURATION);
  EXPECT_THAT(diminish_last_error(), HasSubstr("nose"));
  EXPECT_EQ(diminish_next(pipeline.get(), &output, &more), DIMINISH_OK);
  EXPECT_GT(output.mask_pixels, 10000U);
}

TEST(CApi, ErrorsAreCodesAndOneLine) {
  diminish_pipeline* nothing = nullptr;
  EXPECT_EQ(diminish_open("/nowhere", &nothing), DIMINISH_INPUT);
  EXPECT_EQ(nothing, nullptr);
  EXPECT_THAT(diminish_last_error(), HasSubstr("/nowhere"));
  EXPECT_NE(diminish_open(nullptr, &nothing), DIMINISH_OK);
  EXPECT_NE(diminish_open(calendar.c_str(), nullptr), DIMINISH_OK);
  diminish_close(nullptr);

  const Owned pipeline = opened();
  const auto error_of = [&](const char* name, const char* value) {
    EXPECT_EQ(diminish_set_option(pipeline.get(), name, value), DIMINISH_CONFIGURATION);
    return std::string(diminish_last_error());
  };
  EXPECT_THAT(error_of("margin", "1"), HasSubstr("margin: there is no such option"));
  EXPECT_THAT(error_of("mask_margin_px", "wide"), HasSubstr("mask_margin_px: expected a number"));
  EXPECT_THAT(error_of("mask_margin_px", "-1"), HasSubstr("mask_margin_px"));
  EXPECT_THAT(error_of("smooth_depth", "1"), HasSubstr("true or false"));
  EXPECT_THAT(error_of("inpaint", "magic"), HasSubstr("magic"));

  const std::vector<std::uint8_t> bytes(64);
  const diminish_rgbd none{};
  diminish_output output{};
  diminish_input input{{bytes.data(), 4, 4, 5}, &none, 1, 0};
  EXPECT_EQ(diminish_process(pipeline.get(), &input, &output), DIMINISH_CONFIGURATION);
  EXPECT_THAT(diminish_last_error(), HasSubstr("color: expected a size, and a stride"));
  input.color.stride = 12;
  EXPECT_NE(diminish_process(pipeline.get(), &input, &output), DIMINISH_OK);
  EXPECT_THAT(diminish_last_error(), HasSubstr("1280x1024"));
  input.rgbd_count = 2;
  EXPECT_NE(diminish_process(pipeline.get(), &input, &output), DIMINISH_OK);
  EXPECT_THAT(diminish_last_error(), HasSubstr("rgbd_count: expected 1, got 2"));
  EXPECT_EQ(diminish_process(nullptr, &input, &output), DIMINISH_CONFIGURATION);
}

}  // namespace
}  // namespace diminish
