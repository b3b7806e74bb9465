#include "score/html.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>

namespace diminish {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// Decoded by the alphabet's definition, then by OpenCV.
TEST(Html, DataUrisHoldThePicture) {
  const cv::Mat picture(31, 47, CV_8UC3, cv::Scalar(200, 120, 40));
  const std::string uri = html::data_uri(picture);
  const std::string prefix = "data:image/jpeg;base64,";
  ASSERT_THAT(uri, StartsWith(prefix));
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned bits = 0;
  int count = 0;
  ASSERT_EQ((uri.size() - prefix.size()) % 4, 0U);
  for (const char c : uri.substr(prefix.size())) {
    if (c == '=') break;
    ASSERT_NE(alphabet.find(c), std::string::npos);
    bits = bits << 6 | static_cast<unsigned>(alphabet.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count & 255U));
  }
  const cv::Mat decoded = cv::imdecode(bytes, cv::IMREAD_COLOR);
  ASSERT_EQ(decoded.size(), picture.size());
  EXPECT_LE(cv::norm(decoded, picture, cv::NORM_INF), 4);
}

TEST(Html, EscapesWhatWouldBeMarkup) {
  EXPECT_EQ(html::escaped("<a href=\"x\">&"), "&lt;a href=&quot;x&quot;&gt;&amp;");
}

TEST(Html, PlotsLeaveGapsWhereThereIsNoValue) {
  const std::string plot = html::plot("dB <", {1.0, 2.0, std::nullopt, 4.0});
  EXPECT_THAT(plot, HasSubstr("dB &lt;"));
  EXPECT_THAT(plot, HasSubstr("1 to 4"));
  // The first value at the bottom left, the last at the top right.
  EXPECT_THAT(plot, HasSubstr("points='0.0,90.0 100.0,60.0 '"));
  EXPECT_THAT(plot, HasSubstr("points='300.0,0.0 '"));
  EXPECT_EQ(html::plot("nothing", {std::nullopt}), "");
}

}  // namespace
}  // namespace diminish
