#include "pose/profile.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <array>
#include <random>

#include "core/bilinear.h"

namespace diminish {
namespace {

TEST(Profile, HasTheBilinearLevelsOnEveryInstructionSet) {
  std::mt19937 random(3);
  Image<Bgr> image(61, 47);
  for (Bgr& color : image) {
    color = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  const auto green = [&](int x, int y) { return static_cast<float>(image(x, y).g); };
  for (std::int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
    const std::int64_t target = rest & -rest;
    hwy::SetSupportedTargetsForTest(target);
    // The last one ends on the picture's last pixels.
    for (const Profile& profile :
         {Profile{3.25F, 40.5F, 0.5F, -0.25F, 1}, Profile{3.25F, 40.5F, 0.5F, -0.25F, 17},
          Profile{0, 0, 0.9F, 0.7F, Profile::most}, Profile{9.75F, 45.999F, 0.78F, 0, 64},
          Profile{59.999F, 45.999F, -0.7F, -0.6F, 50}}) {
      std::array<float, Profile::room> levels;
      sample_profile(image, profile, levels.data());
      for (int i = 0; i < profile.count; ++i) {
        const auto t = static_cast<float>(i);
        ASSERT_EQ(levels[static_cast<std::size_t>(i)],
                  bilinear(profile.x + t * profile.step_x, profile.y + t * profile.step_y, green))
            << i << ' ' << hwy::TargetName(target);
      }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace diminish
