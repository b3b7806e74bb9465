#include "bars/bar_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

#include "bars/bar_evidence.h"
#include "core/tasks.h"
#include "geometry/point_projection.h"

namespace diminish {
namespace {

// Of a pair of edges, in pixels of the user's picture.
constexpr float least_parallel = 0.9996F;  ///< cosine
constexpr float narrowest_px = 5;
constexpr float widest_px = 40;
constexpr float farthest_apart_px = 60;  ///< along them, from one's entry to the other's
/// How far a bar is looked at, outside the mask and inside.
constexpr int outside_px = 40;
constexpr int inside_px = 200;
static_assert(outside_px + inside_px <= BarEdges::longest_px);
constexpr int sample_px = 6;  ///< from one label that is looked at to the next

// An edge that leaves the mask on its other side.
constexpr float mate_cosine = 0.995F;
constexpr float shortest_mate_px = 20;
constexpr float mate_px = 3;         ///< from where the bar's edge would leave it ...
constexpr float mate_slope = 0.02F;  ///< ... and so much more for each pixel along the bar

// Distances in front of the plane.
constexpr float nearest_m = 0.01F;
constexpr float step_m = 0.005F;
constexpr int distances = 29;  ///< so many steps
constexpr float refined_step_m = 0.004F;
constexpr int refined_steps = 3;  ///< to both sides
/// Of one that is known, from where it was.
constexpr float known_nearest_m = -0.01F;
constexpr int known_distances = 5;

/// The share of places without depth is this much larger on the bar than beside it.
constexpr float least_share = 0.5F;
constexpr float plateau = 0.95F;  ///< of the largest share, where it is as good as that

/// Both edges are seen in the RGB-D camera's picture, as grey levels.
constexpr float least_contrast = 10;
constexpr float most_contrast = 30;  ///< more do not make it surer

// One that is known from an earlier frame may be less clear, and is preferred.
constexpr float known_share = 0.35F;
constexpr float known_contrast = 8;
constexpr float known_gain = 1.2F;

/// Of an edge's direction: the inverse of its variance.
float weight(const RimLine& line) {
  const auto length = static_cast<float>(line.length);
  return length * length * length;
}

/// The plane that shows at most places along the line, as the user would see it.
const BackgroundPlane* plane_behind(const BarSearch::Input& input, const Bar& bar) {
  std::array<int, BackgroundPlanes::most_planes> counts{};
  for (int along = -outside_px; along <= inside_px; along += sample_px) {
    const auto [x, y] = nearest_pixel(bar.at(static_cast<float>(along), 0));
    if (!input.surfaces.region.contains(x, y)) continue;
    const int plane = input.surfaces.label(x, y) - surface_label::first_plane;
    if (plane >= 0 && plane < static_cast<int>(input.planes.size())) {
      ++counts[static_cast<std::size_t>(plane)];
    }
  }
  const auto best = std::max_element(counts.begin(), counts.end());
  return *best == 0 ? nullptr : &input.planes[static_cast<std::size_t>(best - counts.begin())];
}

BackgroundPlane in_front(const BackgroundPlane& plane, float distance_m) {
  return {plane.normal, plane.distance_m + distance_m};
}

/// How far the bar can be followed inside the mask, up to `inside_px`.
float depth_inside(const Mask& occlusion, const Bar& bar) {
  int along = 1;
  while (along < inside_px && is_hidden(occlusion, bar.at(static_cast<float>(along), 0))) ++along;
  return static_cast<float>(along);
}

/// Whether one of the bar's edges leaves the mask again where it would.
bool goes_on(std::span<const RimLine> lines, const Bar& bar) {
  return std::any_of(lines.begin(), lines.end(), [&](const RimLine& line) {
    const float along = bar.along(line.entry);
    return line.outward.dot(bar.inward) > mate_cosine && along > shortest_mate_px &&
           std::abs(std::abs(bar.side(line.entry)) - bar.width_px / 2) <
               mate_px + mate_slope * along;
  });
}

}  // namespace

bool exclude_each_other(const BarViews& views, const Bar& bar, const Bar& other) {
  // Bars that cross share one place only.
  constexpr float crossing_cosine = 0.9F;
  if (std::abs(bar.inward.dot(other.inward)) < crossing_cosine) return false;
  constexpr float places[] = {0, 20, 40, 60, 80};
  int overlaps = 0;
  for (const float along : places) {
    const float apart = std::abs(other.side(bar.at(along, 0)));
    overlaps += apart < (bar.width_px + other.width_px) / 2 - 2 ? 1 : 0;
  }
  if (overlaps > 1) return true;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto centre = views.centre(k);
    if (!centre) continue;
    int shared = 0;
    for (const float along : places) {
      const Eigen::Vector3f point = meet(bar.plane, views.ray(bar.at(along, 0)));
      const Eigen::Vector3f direction = point - *centre;
      const float slope = other.plane.normal.dot(direction);
      if (std::abs(slope) < 1e-6F) continue;
      const float share = -other.plane.height_m(*centre) / slope;
      const auto at = views.project(*centre + share * direction);
      shared += at && std::abs(other.side(*at)) < other.width_px / 2 ? 1 : 0;
    }
    if (shared > 1) return true;
  }
  return false;
}

bool is_between(const Bar& bar, std::span<const Bar> others) {
  constexpr float parallel = 0.99F;
  constexpr float place_px = 20;    ///< along it, where they are compared
  constexpr float touching_px = 3;  ///< from edge to edge
  float left = 0;
  float right = 0;
  for (const Bar& other : others) {
    if (std::abs(bar.inward.dot(other.inward)) < parallel) continue;
    const float side = bar.side(other.at(other.along(bar.at(place_px, 0)), 0));
    const float gap = std::abs(side) - (bar.width_px + other.width_px) / 2;
    if (std::abs(gap) > touching_px) continue;
    float& score = side < 0 ? left : right;
    score = std::max(score, other.score);
  }
  return left > 0 && right > 0 && left + right > bar.score;
}

/// What two lines are the edges of, if they lie like those of a bar.
std::optional<BarSearch::Pair> BarSearch::pair_of(const Input& input, const RimLine& a,
                                                  const RimLine& b) {
  const Eigen::Vector2f between = b.entry - a.entry;
  if (std::abs(a.outward.dot(b.outward)) < least_parallel || a.outward.dot(b.outward) < 0) {
    return std::nullopt;
  }
  Bar bar;
  bar.inward = -(weight(a) * a.outward + weight(b) * b.outward).normalized();
  bar.width_px = std::abs(bar.across().dot(between));
  const float apart = bar.inward.dot(between);
  if (bar.width_px < narrowest_px || bar.width_px > widest_px ||
      std::abs(apart) > farthest_apart_px) {
    return std::nullopt;
  }
  bar.entry = (a.entry + b.entry) / 2 - std::abs(apart) / 2 * bar.inward;
  int steps = 0;
  while (!is_hidden(input.occlusion, bar.at(1, 0))) {
    if (++steps > static_cast<int>(farthest_apart_px)) return std::nullopt;
    bar.entry += bar.inward;
  }
  const BackgroundPlane* const behind = plane_behind(input, bar);
  if (behind == nullptr) return std::nullopt;
  const auto outside = static_cast<float>(std::min({outside_px, a.length, b.length}));
  return Pair{bar, -outside, std::max(std::abs(apart), depth_inside(input.occlusion, bar)),
              *behind};
}

void BarSearch::judge(const Input& input, const Pair& pair, std::vector<Bar>& found) {
  const Bar& bar = pair.bar;
  const float first_m = pair.is_known ? known_nearest_m : nearest_m;
  const float enough = pair.is_known ? known_share : least_share;
  const auto distance_at = [&](std::ptrdiff_t i) {
    return first_m + static_cast<float>(i) * step_m;
  };
  const BarHole hole(input.views, bar, pair.outer_end, pair.inner_end);
  std::optional<BarEdges> edges;  ///< of few that may be bars
  std::array<float, distances> margins{};
  const auto end = margins.begin() + (pair.is_known ? known_distances : distances);
  for (auto at = margins.begin(); at != end; ++at) {
    *at = hole.margin(in_front(pair.behind, distance_at(at - margins.begin())), enough);
  }
  // Every range of distances is a bar that may be there: one that an RGB-D camera sees beside the
  // hole of another seems to be further in front.
  for (auto begin = margins.begin(); begin != end;) {
    const auto is_enough = [&](float margin) { return margin >= enough; };
    begin = std::find_if(begin, end, is_enough);
    const auto last = std::find_if_not(begin, end, is_enough);
    if (begin == last) break;
    const float most = *std::max_element(begin, last);
    int count = 0;
    float sum_m = 0;
    for (auto at = begin; at != last; ++at) {
      if (*at < plateau * most) continue;
      sum_m += distance_at(at - margins.begin());
      ++count;
    }
    begin = last;
    // Where exactly: as the RGB-D camera's picture shows its edges.
    if (!edges) edges.emplace(input.views, bar, pair.outer_end, pair.inner_end);
    float contrast = 0;
    Bar placed = bar;
    for (int i = -refined_steps; i <= refined_steps; ++i) {
      const float shift_m = static_cast<float>(i) * refined_step_m;
      const BackgroundPlane plane =
          in_front(pair.behind, sum_m / static_cast<float>(count) + shift_m);
      const float its = edges->contrast(plane, contrast);
      if (its <= contrast) continue;
      contrast = its;
      placed.plane = plane;
    }
    if (contrast < (pair.is_known ? known_contrast : least_contrast)) continue;
    placed.goes_on = goes_on(input.lines, placed);
    placed.score = most * std::min(contrast, most_contrast) * (pair.is_known ? known_gain : 1);
    found.push_back(placed);
  }
}

void BarSearch::find(const Input& input) {
  found_.clear();
  bars_.clear();
  pairs_.clear();
  for (std::size_t i = 0; i < input.lines.size(); ++i) {
    for (std::size_t k = i + 1; k < input.lines.size(); ++k) {
      const auto pair = pair_of(input, input.lines[i], input.lines[k]);
      if (pair) pairs_.push_back(*pair);
    }
  }
  for (const Bar& bar : input.known) {
    pairs_.push_back({bar, -static_cast<float>(outside_px), depth_inside(input.occlusion, bar),
                      bar.plane, true});
  }
  if (found_by_pair_.size() < pairs_.size()) found_by_pair_.resize(pairs_.size());
  for_tasks(pairs_.size(), [&](std::size_t i) {
    found_by_pair_[i].clear();
    judge(input, pairs_[i], found_by_pair_[i]);
  });
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    found_.insert(found_.end(), found_by_pair_[i].begin(), found_by_pair_[i].end());
  }
  // Ends with what tells any two apart, so that the order does not depend on the library.
  std::sort(found_.begin(), found_.end(), [](const Bar& a, const Bar& b) {
    return std::tuple(b.score, a.entry.y(), a.entry.x(), a.width_px) <
           std::tuple(a.score, b.entry.y(), b.entry.x(), b.width_px);
  });
  for (const Bar& bar : found_) {
    if (is_between(bar, found_)) continue;
    const bool is_free = std::none_of(bars_.begin(), bars_.end(), [&](const Bar& other) {
      return exclude_each_other(input.views, bar, other);
    });
    if (is_free) bars_.push_back(bar);
  }
}

}  // namespace diminish
