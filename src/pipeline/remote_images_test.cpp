#include <gtest/gtest.h>

#include <cstdlib>

#include "diminish/frame_source.h"
#include "diminish/pipeline.h"
#include "paths.h"
#include "remote_images.h"

namespace diminish {
namespace {

using testing::NodeInProcess;

struct Difference {
  std::size_t pixels = 0, other = 0;  ///< of the mask; more than a level apart
  double squares = 0;
  double mean_square() const { return squares / (3. * static_cast<double>(pixels)); }
};

void compare(const DiminishedFrame& a, const DiminishedFrame& b, Difference& sum) {
  ASSERT_EQ(a.mask, b.mask);
  for (int y = 0; y < a.mask.height(); ++y) {
    for (int x = 0; x < a.mask.width(); ++x) {
      const Bgr p = a.picture(x, y);
      const Bgr q = b.picture(x, y);
      if (a.mask(x, y) == 0) {
        ASSERT_EQ(p, q);
        continue;
      }
      ++sum.pixels;
      int most = 0;
      for (const int d : {p.b - q.b, p.g - q.g, p.r - q.r}) {
        most = std::max(most, std::abs(d));
        sum.squares += d * d;
      }
      sum.other += most > 1 ? 1 : 0;
    }
  }
}

class RemoteImagesTest : public ::testing::Test {
 protected:
  Recording recording_ =
      load_recording(std::filesystem::path(testing::recordings_dir()) / "workbench");

  /// Of the first frames, drawn here and with some cameras elsewhere.
  Difference difference(const Options& options, const std::vector<std::size_t>& remote,
                        const RemoteSettings& settings) {
    Pipeline local(recording_.rig, recording_.scene, options);
    Pipeline merging(recording_.rig, recording_.scene, options);
    std::vector<std::unique_ptr<NodeInProcess>> nodes;
    nodes.reserve(remote.size());
    for (const std::size_t k : remote) {
      nodes.push_back(std::make_unique<NodeInProcess>(recording_, k, settings));
    }
    const auto source = open_recording(recording_, {});
    FrameSet frame;
    Difference sum;
    DiminishedFrame a;
    DiminishedFrame b;
    for (int i = 0; i < frames_ && source->next(frame); ++i) {
      local.process(frame, a);
      for (std::size_t n = 0; n < remote.size(); ++n) {
        nodes[n]->take_over(frame.rgbd[remote[n]]);
      }
      merging.process(frame, b);
      compare(a, b, sum);
      EXPECT_NEAR(
          static_cast<double>(b.report.valid_pixels) / static_cast<double>(a.report.valid_pixels),
          1, 0.002);
      for (RgbdFrame& rgbd : frame.rgbd) rgbd.remote.reset();
    }
    for (const auto& node : nodes) {
      EXPECT_EQ(node->counts().problem, "");
    }
    return sum;
  }

  int frames_ = 3;
};

/// The stages that need no RGB-D images here.
Options comparable() {
  Options options;
  options.memory = "off";
  options.complete_sides = false;
  options.draw_bars = false;
  options.close_gaps = false;
  options.smooth_colors = false;
  return options;
}

const RemoteSettings lossless{{false, 0, 0}, 10}, raw{{true}, 10};

TEST_F(RemoteImagesTest, GiveThePictureOfLocalOnesBitForBit) {
  for (const std::vector<std::size_t>& remote :
       {std::vector<std::size_t>{0}, std::vector<std::size_t>{1}, std::vector<std::size_t>{0, 1}}) {
    for (const RemoteSettings& settings : {lossless, raw}) {
      const Difference found = difference(comparable(), remote, settings);
      EXPECT_GT(found.pixels, 10000U);
      EXPECT_EQ(found.squares, 0);
    }
  }
}

/// Bars are found by images that are not here.
Options without_bars() {
  Options options;
  options.draw_bars = false;
  options.close_gaps = false;
  return options;
}

TEST_F(RemoteImagesTest, DifferLittleWithWhatIsLeftOut) {
  const Difference found = difference(without_bars(), {0, 1}, lossless);
  EXPECT_LE(found.other * 500, found.pixels);
}

TEST_F(RemoteImagesTest, DifferLittleWithWhatIsLost) {
  EXPECT_LT(difference(without_bars(), {0, 1}, {{false, 92, 2e-4}, 10}).mean_square(), 12);
}

}  // namespace
}  // namespace diminish
