#include <gtest/gtest.h>

#include <random>
#include <set>
#include <tuple>

#include "diminish/view_mode.h"

namespace diminish {
namespace {

/// An object in the middle that hides a grey background; the right half of it is invented.
class ViewModes : public ::testing::Test {
 protected:
  ViewModes() {
    std::mt19937 random(5);
    for (Bgr& pixel : camera) pixel.g = static_cast<std::uint8_t>(random());
    camera.fill({20, 10, 40, 30}, {200, 0, 0});
    camera.fill({38, 10, 2, 30}, {255, 255, 255});  // a line on the object
    result.picture = camera;
    result.mask.resize(80, 60, 0);
    result.mask.fill({20, 10, 40, 30}, 255);
    result.picture.fill({20, 10, 40, 30}, {100, 100, 100});
    result.provenance.resize(80, 60, provenance::camera);
    result.provenance.fill({20, 10, 20, 30}, provenance::first_rgbd);
    result.provenance.fill({40, 10, 20, 30}, provenance::inpainted);
  }
  Image<Bgr> shown(const char* mode) {
    DiminishedFrame frame = result;
    Registry<ViewMode>::get(mode)()->show(camera, options, frame);
    return frame.picture;
  }

  Image<Bgr> camera{80, 60};
  DiminishedFrame result;
  Options options;
};

TEST_F(ViewModes, ChangeNothingOutsideTheMask) {
  for (const std::string& mode : Registry<ViewMode>::names()) {
    const Image<Bgr> picture = shown(mode.c_str());
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 80; ++x) {
        if (result.mask(x, y) != 0) continue;
        ASSERT_EQ(picture(x, y), camera(x, y)) << mode;
      }
    }
  }
}

TEST_F(ViewModes, ShowWhatTheirNamesSay) {
  EXPECT_EQ(shown("remove"), result.picture);
  options.transparency = 0.75;
  EXPECT_EQ(shown("half")(25, 20), (Bgr{125, 75, 75}));
  options.transparency = 1;
  EXPECT_EQ(shown("half"), result.picture);
  const Image<Bgr> xray = shown("xray");
  EXPECT_EQ(xray(28, 20), (Bgr{100, 100, 100}));
  EXPECT_GT(xray(37, 20).g, 180) << "the line's edge";
  const Image<Bgr> outline = shown("outline");
  EXPECT_NE(outline(20, 20), (Bgr{100, 100, 100}));
  EXPECT_EQ(outline(23, 20), (Bgr{100, 100, 100}));
}

TEST_F(ViewModes, ProvenanceTellsSeenFromInvented) {
  const Image<Bgr> picture = shown("provenance");
  for (int y = 10; y < 40; ++y) {
    for (int x = 20; x < 60; ++x) {
      if (x < 40) {
        EXPECT_GT(picture(x, y).g, picture(x, y).r);
      } else {
        EXPECT_LT(picture(x, y).g, picture(x, y).r);
      }
    }
  }
}

TEST_F(ViewModes, ProvenanceTellsWhatIsSeenNowFromTheRest) {
  const std::uint8_t origins[] = {provenance::first_rgbd, provenance::witnessed,
                                  provenance::remembered, provenance::estimated};
  std::set<std::tuple<int, int, int>> colors;
  for (const std::uint8_t origin : origins) {
    result.provenance(30, 20) = origin;
    const Bgr color = shown("provenance")(30, 20);
    colors.insert({color.b, color.g, color.r});
  }
  EXPECT_EQ(colors.size(), std::size(origins));
}

}  // namespace
}  // namespace diminish
