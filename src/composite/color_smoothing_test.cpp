#include "composite/color_smoothing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/mat.h"
#include "diminish/diminished_frame.h"

namespace diminish {
namespace {

constexpr std::uint8_t seen = provenance::first_rgbd;
constexpr double noise_levels = 3;

std::uint8_t level(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

/// Two walls that differ by 40 levels in one channel, and a slope.
Image<Bgr> two_walls(int width, int height) {
  Image<Bgr> picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool is_left = 3 * x + y < 2 * width;
      picture(x, y) = {level(is_left ? 60 : 100), level(90 + 0.3 * x), 200};
    }
  }
  return picture;
}

Image<Bgr> with_noise(const Image<Bgr>& picture) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, noise_levels);
  Image<Bgr> noisy = picture;
  for (Bgr& color : noisy) {
    color = {level(color.b + noise(random)), level(color.g + noise(random)),
             level(color.r + noise(random))};
  }
  return noisy;
}

double rms(const Image<Bgr>& a, const Image<Bgr>& b) {
  return cv::norm(as_mat(a), as_mat(b), cv::NORM_L2) /
         std::sqrt(3.0 * static_cast<double>(a.size()));
}

Image<Bgr> smoothed(const Image<Bgr>& picture, const Mask& origins, const Rect& box) {
  Image<Bgr> result = picture;
  ColorSmoothing().smooth(origins, box, ColorSmoothing::whole_change, result);
  return result;
}

/// What ColorSmoothing does, pixel by pixel.
class Plain {
 public:
  Plain(const Image<Bgr>& picture, const Mask& origins, const Rect& box)
      : picture_(picture), origins_(origins), box_(box) {}

  bool is_seen(int x, int y) const {
    return box_.contains(x, y) && origins_(x, y) >= provenance::first_rgbd &&
           origins_(x, y) < provenance::witnessed;
  }
  Bgr smooth(int x, int y, int share) const {
    std::uint32_t sums[3] = {};
    std::uint32_t weights = 0;
    constexpr int reach = ColorSmoothing::reach;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (!ColorSmoothing::is_neighbour(dx, dy) || !is_seen(x + dx, y + dy)) continue;
        int difference = 0;
        for (int c = 0; c < 3; ++c)
          difference += std::abs(guide(x, y, c) - guide(x + dx, y + dy, c));
        const auto left = std::max(0, ColorSmoothing::largest_difference - difference);
        const auto weight = static_cast<std::uint32_t>(left) / ColorSmoothing::weight_part;
        weights += weight;
        for (int c = 0; c < 3; ++c) {
          sums[c] += weight * static_cast<std::uint32_t>(value(x + dx, y + dy, c));
        }
      }
    }
    const auto level = [&](int c) {
      const int change = static_cast<int>(ColorSmoothing::mean(sums[c], weights)) - value(x, y, c);
      const double part = static_cast<double>(share) / ColorSmoothing::whole_change;
      return static_cast<std::uint8_t>(value(x, y, c) + std::floor(change * part + 0.5));
    };
    return {level(0), level(1), level(2)};
  }

 private:
  int value(int x, int y, int c) const {
    const Bgr& color = picture_(x, y);
    return c == 0 ? color.b : c == 1 ? color.g : color.r;
  }
  static int mean_of_three(int first, int second, int own) {
    return ((first + second + 1) / 2 + own + 1) / 2;
  }
  int row_mean(int x, int y, int c) const {
    const int own = value(x, y, c);
    return mean_of_three(is_seen(x - 1, y) ? value(x - 1, y, c) : own,
                         is_seen(x + 1, y) ? value(x + 1, y, c) : own, own);
  }
  int guide(int x, int y, int c) const {
    const int own = row_mean(x, y, c);
    return mean_of_three(is_seen(x, y - 1) ? row_mean(x, y - 1, c) : own,
                         is_seen(x, y + 1) ? row_mean(x, y + 1, c) : own, own);
  }

  const Image<Bgr>& picture_;
  const Mask& origins_;
  Rect box_;
};

TEST(ColorSmoothing, DoesWhatThePlainVersionDoes) {
  std::mt19937 random(7);
  // One after the other: what larger pictures left behind must not matter.
  ColorSmoothing smoothing;
  for (const auto& [width, height] : {std::pair{150, 301},
                                      {96, 270},
                                      {120, 300},
                                      {64, 270},
                                      {90, 300},
                                      {32, 270},
                                      {63, 20},
                                      {31, 33},
                                      {3, 7},
                                      {1, 1}}) {
    Image<Bgr> picture = with_noise(two_walls(width + 9, height + 5));
    Mask origins(width + 9, height + 5);
    for (std::uint8_t& origin : origins) {
      const auto kind = random() % 8;
      origin = kind == 0   ? provenance::camera
               : kind == 1 ? provenance::inpainted
               : kind == 2 ? provenance::unknown
               : kind == 3 ? std::uint8_t{253}
                           : seen;
    }
    for (int i = 0; i < 20; ++i) picture.data()[random() % picture.size()] = {255, 255, 255};
    const Rect box{4, 2, width, height};
    Image<Bgr> result = picture;
    const int share = width % 3 == 0 ? 53 : ColorSmoothing::whole_change;
    smoothing.smooth(origins, box, share, result);
    const Plain plain(picture, origins, box);
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const Bgr expected = plain.is_seen(x, y) ? plain.smooth(x, y, share) : picture(x, y);
        ASSERT_EQ(result(x, y), expected) << x << ' ' << y << " of " << width << 'x' << height;
      }
    }
  }
}

TEST(ColorSmoothing, TakesNoiseOutAndKeepsEdges) {
  const Image<Bgr> truth = two_walls(160, 120);
  const Image<Bgr> noisy = with_noise(truth);
  const Image<Bgr> result = smoothed(noisy, Mask(160, 120, seen), truth.bounds());
  Image<Bgr> bilateral(160, 120);
  cv::bilateralFilter(as_mat(noisy), as_mat(bilateral), 5, 25, 2);
  EXPECT_NEAR(rms(noisy, truth), noise_levels, 0.2);
  EXPECT_LT(rms(result, truth), noise_levels / 2.5);
  EXPECT_LT(rms(result, truth), rms(bilateral, truth));
}

TEST(ColorSmoothing, LeavesWhatHasNoNoise) {
  const Image<Bgr> flat(50, 40, Bgr{17, 128, 250});
  EXPECT_EQ(smoothed(flat, Mask(50, 40, seen), flat.bounds()), flat);
}

// The quotient is that of whole numbers, to a tenth of a level.
TEST(ColorSmoothing, DividesToATenthOfALevel) {
  for (std::uint32_t weight = 9; weight <= 21 * 9; ++weight) {
    for (std::uint32_t sum = 0; sum <= 255 * weight; ++sum) {
      const double exact = static_cast<double>(sum) / weight;
      ASSERT_NEAR(ColorSmoothing::mean(sum, weight), exact, 0.6) << sum << '/' << weight;
    }
  }
}

}  // namespace
}  // namespace diminish
