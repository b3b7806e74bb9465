#include "composite/smoothing_share.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "composite/color_smoothing.h"
#include "core/bilinear.h"
#include "core/tasks.h"

namespace diminish {
namespace {

constexpr int reach = ColorSmoothing::reach + 1;  ///< with the guide's
constexpr int side = 2 * reach + 1;
/// A fourth channel, 0, makes it a vector.
using Color = Eigen::Array4f;
using Window = std::array<std::array<Color, side>, side>;

Color color_of(const Bgr& color) {
  return {static_cast<float>(color.b), static_cast<float>(color.g), static_cast<float>(color.r), 0};
}

Color mean_of_three(const Color& first, const Color& own, const Color& second) {
  return 0.25F * (first + second) + 0.5F * own;
}

/// What ColorSmoothing makes of the pixel in the middle.
Color smoothed(const Window& colors) {
  Window rows;
  for (std::size_t y = 0; y < side; ++y) {
    for (std::size_t x = 1; x + 1 < side; ++x) {
      rows[y][x] = mean_of_three(colors[y][x - 1], colors[y][x], colors[y][x + 1]);
    }
  }
  const auto guide = [&](std::size_t x, std::size_t y) {
    return mean_of_three(rows[y - 1][x], rows[y][x], rows[y + 1][x]);
  };
  const Color own = guide(reach, reach);
  Color sum = Color::Zero();
  float weights = 0;
  for (int dy = -ColorSmoothing::reach; dy <= ColorSmoothing::reach; ++dy) {
    for (int dx = -ColorSmoothing::reach; dx <= ColorSmoothing::reach; ++dx) {
      if (!ColorSmoothing::is_neighbour(dx, dy)) continue;
      const std::size_t x = reach + dx;
      const std::size_t y = reach + dy;
      const float difference = (guide(x, y) - own).abs().sum();
      const float weight =
          std::max(0.F, static_cast<float>(ColorSmoothing::largest_difference) - difference);
      weights += weight;
      sum += weight * colors[y][x];
    }
  }
  return sum / weights;
}

Color mean(const Window& colors) {
  Color sum = Color::Zero();
  for (const auto& row : colors) {
    for (const Color& color : row) sum += color;
  }
  return sum / static_cast<float>(side * side);
}

/// Of a sample: what smoothing changes, and what the colour camera sees instead.
struct Term {
  bool is_found = false;
  float change_residual = 0, change_change = 0;
};

/// step: the RGB-D camera's pixels in one of the colour camera's.
Term term_of(ImageView<Bgr> camera, const Mask& occlusion, ImageView<Bgr> rgbd, float step,
             const SceneSample& sample, const ColorMap& map) {
  constexpr float most = 60;  // levels: more is another surface
  const float margin = step * reach + 1;
  const Eigen::Vector2f& texture = sample.texture;
  const auto x = static_cast<int>(std::lrint(sample.pixel.x()));
  const auto y = static_cast<int>(std::lrint(sample.pixel.y()));
  const Rect around = grow({x, y, 1, 1}, reach);
  if (!(texture.x() > margin && texture.y() > margin &&
        texture.x() < static_cast<float>(rgbd.width() - 1) - margin &&
        texture.y() < static_cast<float>(rgbd.height() - 1) - margin) ||
      intersect(around, camera.bounds()) != around || count_nonzero(occlusion, around) > 0) {
    return {};
  }
  Window drawn;
  Window seen;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const std::size_t column = reach + dx;
      const std::size_t row = reach + dy;
      drawn[row][column] = bilinear(texture.x() + step * static_cast<float>(dx),
                                    texture.y() + step * static_cast<float>(dy),
                                    [&](int u, int v) { return color_of(rgbd(u, v)); });
      seen[row][column] = color_of(camera(x + dx, y + dy));
    }
  }
  const auto mapped = [&](const Color& color) -> Eigen::Array3f {
    return map(color.head<3>(), sample.pixel.x(), sample.pixel.y());
  };
  const Color seen_apart = seen[reach][reach] - mean(seen);
  const Eigen::Array3f own = mapped(drawn[reach][reach]);
  const Eigen::Array3f change = mapped(smoothed(drawn)) - own;
  const Eigen::Array3f residual = seen_apart.head<3>() - (own - mapped(mean(drawn)));
  if (!(residual.abs() < most).all()) return {};
  return {true, (change * residual).sum(), change.square().sum()};
}

}  // namespace

int smoothing_share(const Rig& rig, const FrameSet& frame, const Mask& occlusion,
                    const std::vector<SceneSample>& samples, ColorMapsBySource maps) {
  constexpr std::size_t wanted = 150;
  constexpr int fewest = 30;
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / wanted);
  const std::size_t count = (samples.size() + stride - 1) / stride;
  std::array<Term, 2 * wanted> terms;
  constexpr std::size_t parts = 4;
  for_tasks(parts, [&](std::size_t part) {
    for (std::size_t i = part * count / parts; i < (part + 1) * count / parts; ++i) {
      const SceneSample& sample = samples[i * stride];
      const std::size_t k = sample.source - 1U;
      const auto step = static_cast<float>(rig.rgbd[k].color.fx / rig.color.fx);
      terms[i] =
          term_of(frame.color, occlusion, frame.rgbd[k].color, step, sample, maps[sample.source]);
    }
  });
  int found = 0;
  float change_residual = 0;
  float change_change = 0;
  float squares = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Term& term = terms[i];
    if (!term.is_found) continue;
    ++found;
    change_residual += term.change_residual;
    change_change += term.change_change;
    squares += term.change_residual * term.change_residual;
  }
  constexpr int whole = ColorSmoothing::whole_change;
  if (found < fewest) return whole;
  const float share = (change_residual + std::sqrt(squares)) / std::max(change_change, 1e-6F);
  return static_cast<int>(std::lrint(whole * std::clamp(share, 0.F, 1.F)));
}

}  // namespace diminish
