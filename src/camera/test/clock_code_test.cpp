#include "camera/test/clock_code.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

#include "core/mat.h"

namespace diminish {
namespace {

using testing::Optional;

Image<Bgr> busy_picture(int width, int height) {
  Image<Bgr> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture(x, y) = {static_cast<std::uint8_t>(x * 7 + y), static_cast<std::uint8_t>(x ^ y),
                       static_cast<std::uint8_t>(y * 13)};
    }
  }
  return picture;
}

TEST(ClockCode, SurvivesJpeg) {
  for (const int width : {320, 643, 1280}) {
    Image<Bgr> picture = busy_picture(width, 60);
    for (const std::uint32_t ticks : {0U, 1U, 123456789U, 0xffffffffU, 0xaaaaaaaaU}) {
      draw_clock_code(ticks, picture);
      std::vector<std::uint8_t> bytes;
      cv::imencode(".jpg", as_mat(picture), bytes, {cv::IMWRITE_JPEG_QUALITY, 60});
      Image<Bgr> decoded;
      copy_from(cv::imdecode(bytes, cv::IMREAD_COLOR), decoded);
      EXPECT_THAT(read_clock_code(decoded), Optional(ticks)) << width;
    }
  }
}

TEST(ClockCode, PicturesWithoutOneHaveNone) {
  EXPECT_EQ(read_clock_code(Image<Bgr>(1280, 100)), std::nullopt);
  EXPECT_EQ(read_clock_code(Image<Bgr>(1280, 100, {255, 255, 255})), std::nullopt);
  EXPECT_EQ(read_clock_code(busy_picture(1280, 100)), std::nullopt);
  EXPECT_EQ(read_clock_code(Image<Bgr>(20, 10)), std::nullopt);
}

}  // namespace
}  // namespace diminish
