#include "scene/shadow_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace diminish {
namespace {

constexpr std::size_t directions = 12;

/// Direction d hides a strip of the plane.
std::vector<std::uint8_t> hidden_at(const Eigen::Vector2f& place) {
  std::vector<std::uint8_t> hidden;
  for (std::size_t d = 0; d < directions; ++d) {
    const float angle = 0.5F * static_cast<float>(d);
    const float across = std::cos(angle) * place.x() + std::sin(angle) * place.y();
    const float along = -std::sin(angle) * place.x() + std::cos(angle) * place.y();
    if (std::abs(across) < 0.12F && along > 0 && along < 0.6F) {
      hidden.push_back(static_cast<std::uint8_t>(d));
    }
  }
  return hidden;
}

/// Fits a plane with the light levels(place, hidden).
template <class Levels>
bool fit(ShadowFit& fit, const Levels& levels) {
  std::mt19937 random(4);
  std::normal_distribution<float> noise(0, 3);
  fit.begin(directions);
  for (float x = -0.8F; x < 0.8F; x += 0.05F) {
    for (float y = -0.8F; y < 0.8F; y += 0.05F) {
      const Eigen::Vector2f place(x, y);
      const std::vector<std::uint8_t> hidden = hidden_at(place);
      Eigen::Array3f color = levels(place, hidden);
      color += noise(random);
      if (random() % 10 == 0) color *= 0.4F;  // something else
      fit.add(place, color, hidden);
    }
  }
  return fit.fit();
}

Eigen::Array3f field(const Eigen::Vector2f& p) {
  return Eigen::Array3f(90, 120, 150) * (1 + 0.3F * p.x() - 0.2F * p.y() * p.y());
}
Eigen::Array3f shares(std::uint8_t direction) {
  if (direction == 3) return {0.3F, 0.35F, 0.4F};
  if (direction == 8) return {0.2F, 0.2F, 0.2F};
  return {0, 0, 0};
}

TEST(ShadowFit, FindsHowMuchLightComesFromWhere) {
  ShadowFit found;
  ASSERT_TRUE(fit(found, [](const Eigen::Vector2f& place, const auto& hidden) {
    Eigen::Array3f light = Eigen::Array3f::Ones();
    for (const std::uint8_t d : hidden) light -= shares(d);
    return Eigen::Array3f(field(place) * light);
  }));
  for (std::uint8_t d = 0; d < directions; ++d) {
    EXPECT_LT((found.share(d) - shares(d)).abs().maxCoeff(), 0.06F)
        << int{d} << " " << found.share(d).transpose();
  }
}

TEST(ShadowFit, SeesNoShadowOnAnEvenPlane) {
  ShadowFit found;
  EXPECT_FALSE(fit(found, [](const Eigen::Vector2f& place, const auto&) { return field(place); }));
}

TEST(ShadowFit, TakesAPatchOfAnotherColorForNoShadow) {
  ShadowFit found;
  EXPECT_FALSE(fit(found, [](const Eigen::Vector2f& place, const auto& hidden) {
    const bool on_mat = std::find(hidden.begin(), hidden.end(), 3) != hidden.end();
    return Eigen::Array3f(field(place) *
                          (on_mat ? Eigen::Array3f(0.9F, 0.6F, 0.4F) : Eigen::Array3f(1, 1, 1)));
  }));
}

// Darker than any light from elsewhere would allow.
TEST(ShadowFit, TakesABlackPatchForNoShadow) {
  ShadowFit found;
  EXPECT_FALSE(fit(found, [](const Eigen::Vector2f& place, const auto& hidden) {
    return Eigen::Array3f(field(place) * (hidden.empty() ? 1.F : 0.05F));
  }));
}

TEST(ShadowFit, WithoutPointsThereIsNone) {
  ShadowFit empty;
  empty.begin(directions);
  EXPECT_FALSE(empty.fit());
}

}  // namespace
}  // namespace diminish
