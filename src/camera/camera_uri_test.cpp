#include "diminish/camera_source.h"
#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CameraUri, HasSchemeTargetAndParameters) {
  const CameraUri uri = parse_camera_uri("v4l2:/dev/video0?size=1280x1024&fps=30&mirror");
  EXPECT_EQ(uri.scheme, "v4l2");
  EXPECT_EQ(uri.target, "/dev/video0");
  EXPECT_EQ(uri.text_of("size", ""), "1280x1024");
  EXPECT_EQ(uri.number("fps", 0, 1, 1000), 30);
  EXPECT_TRUE(uri.has("mirror"));
  EXPECT_FALSE(uri.has("rate"));
  EXPECT_EQ(uri.number("rate", 2.5, 0, 10), 2.5);
}

TEST(CameraUri, APipelinesTextIsItsOwn) {
  const std::string pipeline = "videotestsrc pattern=ball ! video/x-raw,format=BGR?&=";
  EXPECT_EQ(parse_camera_uri("gst:" + pipeline).target, pipeline);
}

// Whether a target is free text is for the scheme to say.
TEST(CameraUri, ASchemeDeclaresThatItsTargetIsFreeText) {
  CameraSource::Entry entry;
  Registry<CameraSource>::add("plain", entry);
  entry.free_text = true;
  Registry<CameraSource>::add("verbatim", entry);
  Registry<CameraSource>::leave_out("telegraph", "a wire");
  EXPECT_EQ(parse_camera_uri("plain:x?y=1").target, "x");
  EXPECT_EQ(parse_camera_uri("verbatim:x?y=1").target, "x?y=1");
  EXPECT_EQ(
      error_of([] { open_camera("telegraph:x?=", {}); })
          .rfind(
              "telegraph:x?=: unknown kind "
              "of camera 'telegraph', which this build is without (it was built without a wire), ",
              0),
      0U);
}

TEST(CameraUri, ComplaintsNameTheUriAndWhatWasExpected) {
  EXPECT_THAT(error_of([] { parse_camera_uri("/dev/video0"); }),
              AllOf(HasSubstr("/dev/video0: expected a camera"), HasSubstr("recording")));
  EXPECT_THAT(error_of([] { parse_camera_uri("a:b?=3"); }), HasSubstr("expected key=value"));
  const CameraUri uri = parse_camera_uri("recording:x?rate=fast&speed=2");
  EXPECT_THAT(error_of([&] { uri.number("rate", 1, 0.01, 100); }),
              AllOf(HasSubstr("recording:x?rate=fast"), HasSubstr("rate: expected a number"),
                    HasSubstr("'fast'")));
  EXPECT_THAT(error_of([&] {
                uri.expect_parameters({"rate", "loop"});
              }),
              AllOf(HasSubstr("unknown parameter 'speed'"), HasSubstr("rate, loop")));
  EXPECT_THAT(error_of([] { open_camera("telepathy:x", {}); }),
              AllOf(HasSubstr("unknown kind of camera 'telepathy'"), HasSubstr("recording")));
}

}  // namespace
}  // namespace diminish
