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

Rig with_picture(Rig rig, const Intrinsics& color) {
  rig.color = color;
  return rig;
}

}  // namespace

KeyframeDepth::KeyframeDepth(const Rig& rig, const KeyframeGrid& grid)
    : grid_(grid),
      depth_(with_picture(rig, grid.intrinsics())),
      drawer_(Registry<Reconstructor>::get("cpu")(with_picture(rig, grid.intrinsics()))),
      planes_(grid.intrinsics()),
      carried_(grid) {}

void KeyframeDepth::draw(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
                         const SceneSamples& samples, const Options& options) {
  const Rect whole = grid_.intrinsics().bounds();
  depth_.clean(frame, poses, masks, whole, options);
  drawer_->reconstruct(frame, depth_.depths(), poses, masks, TiledRegion(whole), options, drawn_);
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
  columns_.resize(width, height);
  const auto follow = [&](int y, int previous, float Ends::*end, int Ends::*distance) {
    for (int x = 0; x < width; ++x) {
      Ends& ends = columns_(x, y);
      const bool is_seen = seen_(x, y) > 0;
      const bool has_previous = previous >= 0 && previous < height;
      ends.*end = is_seen ? seen_(x, y) : has_previous ? columns_(x, previous).*end : 0;
      ends.*distance = is_seen || !has_previous ? 0 : columns_(x, previous).*distance + 1;
    }
  };
  for (int y = 0; y < height; ++y) follow(y, y - 1, &Ends::first, &Ends::to_first);
  for (int y = height - 1; y >= 0; --y) follow(y, y + 1, &Ends::last, &Ends::to_last);
}

KeyframeDepth::Guess KeyframeDepth::between(const Ends& ends) {
  constexpr float same_surface = 0.06F;
  const int span = ends.to_first + ends.to_last;
  if (ends.first == 0 || ends.last == 0)
    return {std::max(ends.first, ends.last), span, false, guess_doubt};
  const float nearer = std::max(ends.first, ends.last);
  const float further = std::min(ends.first, ends.last);
  if (nearer - further > same_surface * nearer) return {further, span, false, guess_doubt};
  const float part = static_cast<float>(ends.to_first) / static_cast<float>(span);
  return {ends.first + part * (ends.last - ends.first), span, true, 0};
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
  const Rect around = intersect(grow({end.x, end.y, 1, 1}, reach), colors_.bounds());
  for (int row = around.y; row < around.bottom(); ++row) {
    for (int column = around.x; column < around.right(); ++column) {
      if (seen_(column, row) > 0 &&
          squared_difference(colors_(column, row), colors_(x, y)) < alike) {
        return true;
      }
    }
  }
  return false;
}

KeyframeDepth::Guess KeyframeDepth::guess(int x, int y, const Ends& row) const {
  const Ends& column = columns_(x, y);
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
  const bool looks_so = continues(plane, x, y, {row.first, x - row.to_first, y}) ||
                        continues(plane, x, y, {row.last, x + row.to_last, y}) ||
                        continues(plane, x, y, {column.first, x, y - column.to_first}) ||
                        continues(plane, x, y, {column.last, x, y + column.to_last});
  return {on_plane, 0, false, looks_so ? plane_doubt : guess_doubt};
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
        int end = x;
        while (end < width && !(seen_(end, y) > 0)) ++end;
        const float before = x > 0 ? seen_(x - 1, y) : 0;
        const float after = end < width ? seen_(end, y) : 0;
        for (int i = x; i < end; ++i) {
          const Guess found = guess(i, y, {before, after, i - x + 1, end - i});
          completed_(i, y) = found.inverse_z;
          doubt_(i, y) = static_cast<std::uint8_t>(std::lrint(found.doubt / doubt_unit));
        }
        x = end;
      }
    }
  });
}

}  // namespace diminish
