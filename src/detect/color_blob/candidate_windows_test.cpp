#include "detect/color_blob/candidate_windows.h"

#include <gtest/gtest.h>

#include "detect/color_blob/color_model.h"

namespace diminish {
namespace {

constexpr Bgr orange{20, 120, 230};
constexpr Bgr grey{100, 105, 100};

class CandidateWindowsOfOrange : public ::testing::Test {
 protected:
  CandidateWindowsOfOrange() : image(400, 300, grey) {
    // Hue 28.6 degrees, saturation 0.913, value 0.902.
    model.hue_deg = 28.6;
    model.hue_spread_deg = 3;
    model.saturation = 0.913;
    model.saturation_spread = 0.05;
    model.value = 0.902;
    model.value_spread = 0.1;
  }

  std::vector<Rect> find(double fewest_core = 1, int margin = 0, double margin_part = 0) {
    const CandidateWindows::Limits limits{ColorTable::per_deviation, 2 * ColorTable::per_deviation,
                                          fewest_core, margin, margin_part};
    return windows.find(image, ColorTable(model), pitch, limits);
  }

  static constexpr int pitch = 8;
  ColorModel model;
  Image<Bgr> image;
  CandidateWindows windows;
};

TEST_F(CandidateWindowsOfOrange, LieAroundWhatHasTheColour) {
  EXPECT_TRUE(find().empty());
  image.fill({80, 64, 40, 24}, orange);  // samples 10 to 14 and 8 to 10
  image.fill({320, 240, 16, 16}, orange);
  // One sample more on each side, and the margin.
  EXPECT_EQ(find(), (std::vector<Rect>{{9, 7, 7, 5}, {39, 29, 4, 4}}));
  EXPECT_EQ(find(1, 2, 0.5), (std::vector<Rect>{{4, 2, 17, 15}, {35, 25, 12, 12}}));
  EXPECT_EQ(find(5), (std::vector<Rect>{{9, 7, 7, 5}}));
  EXPECT_TRUE(find(16).empty());
}

TEST_F(CandidateWindowsOfOrange, AreCutOffByThePictureAndJoinedWhereTheyOverlap) {
  image.fill({0, 0, 16, 16}, orange);
  image.fill({48, 0, 16, 16}, orange);
  EXPECT_EQ(find(), (std::vector<Rect>{{0, 0, 3, 3}, {5, 0, 4, 3}}));
  EXPECT_EQ(find(1, 2), (std::vector<Rect>{{0, 0, 11, 5}}));
}

TEST_F(CandidateWindowsOfOrange, GoAcrossASpoiltSample) {
  image.fill({80, 80, 64, 8}, orange);
  image.fill({104, 80, 8, 8}, {255, 255, 255});
  EXPECT_EQ(find().size(), 1U);
}

TEST_F(CandidateWindowsOfOrange, OfAPictureSmallerThanASample) {
  image = Image<Bgr>(3, 1, orange);
  EXPECT_EQ(find(), (std::vector<Rect>{{0, 0, 1, 1}}));
}

}  // namespace
}  // namespace diminish
