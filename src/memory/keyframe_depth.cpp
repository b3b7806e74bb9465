#include "memory/keyframe_depth.h"

#include <algorithm>
#include <cmath>

#include "core/rows.h"

namespace diminish {
namespace {

/// How much of the depth may be wrong where something is thought to go on, and where it is a plane
/// and looks like it.
constexpr float guess_doubt = 0.2F;
constexpr float plane_doubt = 0.05F;

/// planes: in the user's camera's frame. depth_m: 0 where there is none.
void draw_planes(std::span<const InversePlane> planes, const KeyframeGrid& grid,
                 Image<float>& depth_m) {
  const int width = grid.intrinsics().width;
  const int height = grid.intrinsics().height;
  depth_m.resize(width, height);
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < width; ++x) {
        const double inverse = nearest_inverse_depth(planes, grid.ray(x, y).cast<double>());
        depth_m(x, y) = inverse > 0 ? static_cast<float>(1 / inverse) : 0;
      }
    }
  });
}

}  // namespace

KeyframeDepth::KeyframeDepth(const Rig& rig, const KeyframeGrid& grid, bool is_users)
    : grid_(grid),
      gap_doubt_(is_users ? 0 : plane_doubt),
      measured_(rig, grid),
      planes_(grid.intrinsics()),
      carried_(grid) {}

void KeyframeDepth::draw(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                         const SceneSamples& samples, std::span<const InversePlane> planes,
                         const Options& options) {
  drawn_.region = TiledRegion(grid_.intrinsics().bounds());
  if (planes.empty()) {
    measured_.draw(frame, poses, masks, options, drawn_.depth_m);
  } else {
    draw_planes(planes, grid_, drawn_.depth_m);
  }
  label(samples);
}

void KeyframeDepth::complete(const Mask& objects, Keyframe& keyframe) {
  fill_gaps(keyframe, objects);
  edges_.align(colors_, completed_);
  keyframe.doubt = doubt_;
  keyframe.depth.resize(completed_.width(), completed_.height());
  std::transform(completed_.begin(), completed_.end(), keyframe.depth.begin(), [](float inverse_z) {
    constexpr auto units = static_cast<float>(1 / KeyframeGrid::unit_m);
    constexpr float most = 65535;
    const float value = inverse_z > 0 ? units / inverse_z : 0;
    return static_cast<std::uint16_t>(value < most ? std::lrint(value) : 0);
  });
}

void KeyframeDepth::label(const SceneSamples& samples) {
  samples_ = samples.surfaces;
  for (SceneSample& sample : samples_) sample.pixel /= static_cast<float>(grid_.step());
  planes_.find(grid_.intrinsics().bounds(), samples_);
  planes_.label(drawn_, surfaces_);
}

void KeyframeDepth::find_columns() {
  const int width = seen_.width();
  const int height = seen_.height();
  for (Image<float>* ends : {&above_, &below_}) ends->resize(width, height);
  for (Image<std::int32_t>* distances : {&to_above_, &to_below_}) {
    distances->resize(width, height);
  }
  const auto follow = [&](int y, int previous, Image<float>& ends, Image<std::int32_t>& distances) {
    const float* const seen = seen_.row(y);
    float* const end = ends.row(y);
    std::int32_t* const distance = distances.row(y);
    if (previous < 0 || previous >= height) {
      std::copy_n(seen, width, end);
      std::fill_n(distance, width, 0);
      return;
    }
    const float* const end_before = ends.row(previous);
    const std::int32_t* const distance_before = distances.row(previous);
    for (int x = 0; x < width; ++x) {
      const float before = end_before[x];
      const std::int32_t further = distance_before[x] + 1;
      end[x] = seen[x] > 0 ? seen[x] : before;
      distance[x] = seen[x] > 0 ? 0 : further;
    }
  };
  for (int y = 0; y < height; ++y) follow(y, y - 1, above_, to_above_);
  for (int y = height - 1; y >= 0; --y) follow(y, y + 1, below_, to_below_);
}

KeyframeDepth::Guess KeyframeDepth::between(const Ends& ends) const {
  constexpr float same_surface = 0.06F;
  const int span = ends.to_first + ends.to_last;
  if (ends.first == 0 || ends.last == 0)
    return {std::max(ends.first, ends.last), span, false, guess_doubt};
  const float nearer = std::max(ends.first, ends.last);
  const float further = std::min(ends.first, ends.last);
  if (nearer - further > same_surface * nearer) return {further, span, false, guess_doubt};
  const float part = static_cast<float>(ends.to_first) / static_cast<float>(span);
  return {ends.first + part * (ends.last - ends.first), span, true, gap_doubt_};
}

bool KeyframeDepth::continues(const BackgroundPlane& plane, int x, int y, const End& end) const {
  constexpr float on_plane = 0.03F;
  constexpr int reach = 2;
  constexpr int alike = 300;  // squared levels
  if (!(end.inverse_z > 0)) return false;
  const Eigen::Vector2f ray = grid_.ray(end.x, end.y);
  if (std::abs(plane.inverse_depth(ray.x(), ray.y()) - end.inverse_z) > on_plane * end.inverse_z) {
    return false;
  }
  const Bgr& own = colors_(x, y);
  const Rect around = intersect(grow({end.x, end.y, 1, 1}, reach), colors_.bounds());
  for (int row = around.y; row < around.bottom(); ++row) {
    for (int column = around.x; column < around.right(); ++column) {
      if (seen_(column, row) > 0 && squared_difference(colors_(column, row), own) < alike) {
        return true;
      }
    }
  }
  return false;
}

KeyframeDepth::Guess KeyframeDepth::guess(int x, int y, const Ends& row, LastPlace& last) const {
  const Ends column = column_ends(x, y);
  const Guess across = between(row);
  const Guess along = between(column);
  const auto is_better = [](const Guess& a, const Guess& b) {
    if (a.is_same != b.is_same) return a.is_same;
    if ((a.inverse_z > 0) != (b.inverse_z > 0)) return a.inverse_z > 0;
    return a.span <= b.span;
  };
  const Guess& better = is_better(across, along) ? across : along;
  if (better.is_same) return better;
  const std::uint8_t label = surfaces_.label(x, y);
  if (label == surface_label::unknown || label == surface_label::foreground) return better;
  const BackgroundPlane& plane = planes_.planes()[label - surface_label::first_plane];
  const Eigen::Vector2f ray = grid_.ray(x, y);
  const float on_plane = plane.inverse_depth(ray.x(), ray.y());
  const float nearest = std::max({row.first, row.last, column.first, column.last});
  constexpr float margin = 1.1F;
  if (!(on_plane > 0 && on_plane < margin * nearest)) return better;
  // Neighbours look alike: one of two is asked.
  if (x % 2 == 0 || last.label != label || last.x != x - 1) {
    last.continues = continues(plane, x, y, {row.first, x - row.to_first, y}) ||
                     continues(plane, x, y, {row.last, x + row.to_last, y}) ||
                     continues(plane, x, y, {column.first, x, y - column.to_first}) ||
                     continues(plane, x, y, {column.last, x, y + column.to_last});
  }
  last.label = label;
  last.x = x;
  return {on_plane, 0, false, last.continues ? plane_doubt : guess_doubt};
}

void KeyframeDepth::fill_gaps(const Keyframe& keyframe, const Mask& objects) {
  const int width = drawn_.depth_m.width();
  const int height = drawn_.depth_m.height();
  seen_.resize(width, height);
  std::transform(drawn_.depth_m.begin(), drawn_.depth_m.end(), seen_.begin(),
                 [](float z) { return z > 0 ? 1 / z : 0.F; });
  grid_.sample(keyframe.picture, colors_);
  carried_.fill(keyframe.color_from_world, colors_, objects, seen_);
  completed_ = seen_;
  doubt_.resize(width, height, 0);
  find_columns();
  for_rows(height, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < width; ++x) {
        if (seen_(x, y) > 0) continue;
        LastPlace last;
        int end = x;
        while (end < width && !(seen_(end, y) > 0)) ++end;
        const float before = x > 0 ? seen_(x - 1, y) : 0;
        const float after = end < width ? seen_(end, y) : 0;
        for (int i = x; i < end; ++i) {
          // What is under an object is left out anyway.
          if (objects(i * grid_.step(), y * grid_.step()) != 0) continue;
          const Guess found = guess(i, y, {before, after, i - x + 1, end - i}, last);
          completed_(i, y) = found.inverse_z;
          doubt_(i, y) = static_cast<std::uint8_t>(std::lrint(found.doubt / doubt_unit));
        }
        x = end;
      }
    }
  });
}

}  // namespace diminish
