#include "ros/messages.h"

#include <gmock/gmock.h>

#include <limits>

#include "expect_error.h"

namespace diminish::ros {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

ImageMessage small_image(const Bytes& pixels) {
  ImageMessage image;
  image.header = {.stamp_s = 5.25, .frame_id = "eye"};
  image.height = 1;
  image.width = 2;
  image.encoding = "mono8";
  image.step = 2;
  image.data = pixels;
  return image;
}

// Written by hand after the rules of CDR: each number at a multiple of its size.
const Bytes image_in_cdr = {0, 1, 0, 0,                          // CDR_LE
                            5, 0, 0, 0, 0x80, 0xb2, 0xe6, 0x0e,  // 5 s, 250,000,000 ns
                            4, 0, 0, 0, 'e',  'y',  'e',  0,     // frame_id
                            1, 0, 0, 0, 2,    0,    0,    0,     // height, width
                            6, 0, 0, 0, 'm',  'o',  'n',  'o',  '8', 0,
                            0, 0,  // encoding, is_bigendian, a gap
                            2, 0, 0, 0, 2,    0,    0,    0,    7,   9};    // step, data
const Bytes image_in_cdr_big_endian = {0, 0, 0, 0,                          // CDR_BE
                                       0, 0, 0, 5, 0x0e, 0xe6, 0xb2, 0x80,  //
                                       0, 0, 0, 4, 'e',  'y',  'e',  0,     //
                                       0, 0, 0, 1, 0,    0,    0,    2,     //
                                       0, 0, 0, 6, 'm',  'o',  'n',  'o',  '8', 0, 0, 0,  //
                                       0, 0, 0, 2, 0,    0,    0,    2,    7,   9};
const Bytes image_in_ros1 = {0, 0, 0, 0,                                  // seq
                             5, 0, 0, 0, 0x80, 0xb2, 0xe6, 0x0e,          //
                             3, 0, 0, 0, 'e',  'y',  'e',                 // no zero, no gaps
                             1, 0, 0, 0, 2,    0,    0,    0,             //
                             5, 0, 0, 0, 'm',  'o',  'n',  'o',  '8', 0,  //
                             2, 0, 0, 0, 2,    0,    0,    0,    7,   9};

TEST(Messages, AnImageHasTheBytesThatTheFormatsDefine) {
  const Bytes pixels = {7, 9};
  Bytes bytes;
  write_message(small_image(pixels), bytes);
  EXPECT_THAT(bytes, ElementsAreArray(image_in_cdr));
  write_message(small_image(pixels), bytes, Wire::ros1);
  EXPECT_THAT(bytes, ElementsAreArray(image_in_ros1));
}

TEST(Messages, AnImageIsReadInEachFormat) {
  for (const auto& [bytes, wire] :
       {std::pair{image_in_cdr, Wire::cdr}, std::pair{image_in_cdr_big_endian, Wire::cdr},
        std::pair{image_in_ros1, Wire::ros1}}) {
    const auto image = read_message<ImageMessage>(bytes, wire);
    EXPECT_DOUBLE_EQ(image.header.stamp_s, 5.25);
    EXPECT_EQ(image.header.frame_id, "eye");
    EXPECT_EQ(image.height, 1U);
    EXPECT_EQ(image.width, 2U);
    EXPECT_EQ(image.encoding, "mono8");
    EXPECT_EQ(image.step, 2U);
    EXPECT_THAT(image.data, ElementsAre(7, 9));
  }
}

void expect_whole(const Bytes& bytes, Wire wire) {
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_THAT(error_of([&] { read_message<ImageMessage>(cut, wire); }),
                HasSubstr("ends too early"))
        << length;
  }
}

TEST(Messages, EveryShorterMessageIsRefused) {
  expect_whole(image_in_cdr, Wire::cdr);
  expect_whole(image_in_ros1, Wire::ros1);
}

CameraInfoMessage some_info() {
  CameraInfoMessage info;
  info.header = {.stamp_s = 1.7e9, .frame_id = "camera_color_optical_frame"};
  info.height = 480;
  info.width = 640;
  info.distortion_model = "plumb_bob";
  info.d = {.1, -.2, .001, .002, .05};
  info.k = {600, 0, 320, 0, 601, 240, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {590, 0, 321, 0, 0, 591, 241, 0, 0, 0, 1, 0};
  info.binning_x = 2;
  info.roi_width = 7;
  info.roi_is_rectified = true;
  return info;
}

TEST(Messages, EachIsReadAsItWasWritten) {
  RigidTransform pose;
  pose.rotation = Eigen::AngleAxisd(.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation = {.1, -.2, .3};
  const Bytes jpeg = {1, 2, 3}, depth = {4, 5, 6, 7, 8};
  RgbdMessage rgbd;
  rgbd.color = {{.stamp_s = 1.5, .frame_id = "c"}, "jpeg", jpeg};
  rgbd.depth = {{.stamp_s = 1.25, .frame_id = "d"}, "16UC1; compressedDepth rvl", depth};
  rgbd.color_info = rgbd.depth_info = some_info();
  rgbd.depth_unit_m = .00025;
  rgbd.color_from_depth = pose;
  Bytes bytes;
  for (const Wire wire : {Wire::cdr, Wire::ros1}) {
    write_message(rgbd, bytes, wire);
    const auto read = read_message<RgbdMessage>(bytes, wire);
    EXPECT_THAT(read.color.data, ElementsAre(1, 2, 3));
    EXPECT_THAT(read.depth.data, ElementsAre(4, 5, 6, 7, 8));
    EXPECT_EQ(read.depth.format, rgbd.depth.format);
    EXPECT_EQ(read.depth.header.stamp_s, 1.25);
    EXPECT_EQ(read.color_info.d, some_info().d);
    EXPECT_EQ(read.depth_info.k, some_info().k);
    EXPECT_EQ(read.depth_info.p, some_info().p);
    EXPECT_EQ(read.depth_info.binning_x, 2U);
    EXPECT_EQ(read.depth_info.roi_width, 7U);
    EXPECT_TRUE(read.depth_info.roi_is_rectified);
    EXPECT_EQ(read.depth_unit_m, .00025);
    EXPECT_TRUE(read.color_from_depth.rotation.isApprox(pose.rotation, 1e-12));
    EXPECT_TRUE(read.color_from_depth.translation.isApprox(pose.translation));
  }
  const TfMessage tf{{{{.stamp_s = 2, .frame_id = "map"}, "camera", pose}, {{}, "b", {}}}};
  write_message(tf, bytes);
  const auto read_tf = read_message<TfMessage>(bytes);
  ASSERT_EQ(read_tf.transforms.size(), 2U);
  EXPECT_EQ(read_tf.transforms[0].child, "camera");
  EXPECT_TRUE(read_tf.transforms[0].parent_from_child.rotation.isApprox(pose.rotation, 1e-12));
  EXPECT_EQ(read_tf.transforms[1].child, "b");
  const DiagnosticArray state{{.stamp_s = 3},
                              {{DiagnosticStatus::warn, "n", "m", "h", {{"k", "v"}}}}};
  write_message(state, bytes);
  const auto read_state = read_message<DiagnosticArray>(bytes);
  ASSERT_EQ(read_state.statuses.size(), 1U);
  EXPECT_EQ(read_state.statuses[0].level, DiagnosticStatus::warn);
  EXPECT_EQ(read_state.statuses[0].message, "m");
  ASSERT_EQ(read_state.statuses[0].values.size(), 1U);
  EXPECT_EQ(read_state.statuses[0].values[0][1], "v");
}

TEST(Messages, AStampJustBelowASecondIsNotRoundedOutOfRange) {
  Bytes bytes;
  ImageMessage image = small_image({});
  image.header.stamp_s = 2 - 1e-12;
  write_message(image, bytes);
  EXPECT_DOUBLE_EQ(read_message<ImageMessage>(bytes).header.stamp_s, 2);
}

TEST(Messages, ClaimsAreNotBelieved) {
  Bytes bytes;
  write_message(TfMessage{{TransformStamped{}}}, bytes);
  bytes[4] = 200;  // transforms
  EXPECT_THAT(error_of([&] { read_message<TfMessage>(bytes); }),
              HasSubstr("expected a list of at most 1 entries, got 200"));
  bytes = image_in_cdr;
  bytes[1] = 3;
  EXPECT_THAT(error_of([&] { read_message<ImageMessage>(bytes); }),
              HasSubstr("expected a message in plain CDR, got encapsulation 3"));
  CameraInfoMessage info = some_info();
  info.k[0] = std::numeric_limits<double>::quiet_NaN();
  write_message(info, bytes);
  EXPECT_THAT(error_of([&] { read_message<CameraInfoMessage>(bytes); }), HasSubstr("finite"));
  TransformStamped flat;
  flat.parent_from_child.rotation.setConstant(5);
  write_message(TfMessage{{flat}}, bytes);
  EXPECT_THAT(error_of([&] { read_message<TfMessage>(bytes); }), HasSubstr("quaternion"));
}

}  // namespace
}  // namespace diminish::ros
