#include <gtest/gtest.h>

#include <Eigen/Sparse>
#include <cmath>
#include <random>

#include "diminish/inpainter.h"

namespace diminish {
namespace {

Image<Bgr> inpaint(const Image<Bgr>& picture, const Mask& missing,
                   const char* method = "harmonic") {
  Image<Bgr> filled = picture;
  EXPECT_TRUE(Registry<Inpainter>::get(method)()->inpaint({missing, missing, {}}, {}, filled));
  return filled;
}

// A ramp is harmonic: whatever the hole, it is filled exactly.
TEST(HarmonicInpainting, ContinuesARamp) {
  Image<Bgr> picture(90, 70);
  Mask missing(90, 70, 0);
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 90; ++x) {
      picture(x, y) = {static_cast<std::uint8_t>(2 * x), static_cast<std::uint8_t>(3 * y),
                       static_cast<std::uint8_t>(x + y)};
      if (std::hypot(x - 40, y - 35) < 25 || (x > 10 && x < 80 && y == 8)) missing(x, y) = 255;
    }
  }
  EXPECT_EQ(inpaint(picture, missing), picture);
}

TEST(HarmonicInpainting, EqualsADirectSolve) {
  std::mt19937 random(4);
  Image<Bgr> picture(60, 45);
  Mask missing(60, 45, 0);
  for (Bgr& pixel : picture) pixel = {static_cast<std::uint8_t>(random()), 0, 0};
  missing.fill({0, 5, 30, 30}, 255);  // at the picture's edge: free there
  missing.fill({35, 10, 15, 2}, 255);
  Image<int> index(60, 45, -1);
  int count = 0;
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      if (missing(x, y) != 0) index(x, y) = count++;
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      if (index(x, y) < 0) continue;
      for (const auto& [nx, ny] :
           {std::pair(x + 1, y), std::pair(x - 1, y), std::pair(x, y + 1), std::pair(x, y - 1)}) {
        if (!picture.bounds().contains(nx, ny)) continue;
        entries.emplace_back(index(x, y), index(x, y), 1.0);
        if (index(nx, ny) >= 0) {
          entries.emplace_back(index(x, y), index(nx, ny), -1.0);
        } else {
          right[index(x, y)] += picture(nx, ny).b;
        }
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd exact =
      Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  // Half a level for rounding and what the solver may leave of neighbours that differ by 255.
  for (const auto& [method, tolerance] :
       {std::pair("harmonic_reference", 0.65), std::pair("harmonic", 1.3)}) {
    const Image<Bgr> filled = inpaint(picture, missing, method);
    for (int y = 0; y < 45; ++y) {
      for (int x = 0; x < 60; ++x) {
        if (index(x, y) < 0) {
          ASSERT_EQ(filled(x, y), picture(x, y));
        } else {
          ASSERT_NEAR(filled(x, y).b, exact[index(x, y)], tolerance) << method;
        }
      }
    }
  }
}

}  // namespace
}  // namespace diminish
