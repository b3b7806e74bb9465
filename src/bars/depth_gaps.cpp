#include "bars/depth_gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/channels.h"
#include "core/rows.h"
#include "diminish/diminished_frame.h"

namespace diminish {
namespace {

/// Nodes across the picture: enough to tell what is where.
constexpr int most_node_columns = 320;
/// Nodes: what is further away says nothing.
constexpr int gap_rim_reach = 32;
/// A surface is at most this share nearer or further away than what is around it.
constexpr float range_slack = 0.03F;
constexpr std::size_t tried_depths = 6;
/// Of these, an RGB-D camera must look at.
constexpr int fewest_looks = 2;
/// Levels: colours that are alike.
constexpr float same_color = 25;
/// Nodes around the objects that must confirm a group, and how well half of them must, in levels.
constexpr std::size_t fewest_witnesses = 5;
constexpr float confirmed_error = 15;

constexpr float not_looked_at = -1;

/// Rows of nodes.
constexpr int node_rows_together = 4;

}  // namespace

DepthGaps::DepthGaps(const Rig& rig)
    : shadows_(rig), step_((rig.color.width + most_node_columns - 1) / most_node_columns) {}

bool DepthGaps::find_known(const Mask& occlusion, const Reconstruction& reconstruction) {
  bool is_any_hidden = false;
  const int columns = (part_.width + step_ - 1) / step_;
  const int rows = (part_.height + step_ - 1) / step_;
  known_.resize(columns, rows);
  above_.resize(columns, rows);
  below_.resize(columns, rows);
  right_.resize(columns, rows);
  nodes_.resize(columns, rows);
  // Of a node, what is known there or of an end beyond it.
  const auto next_to = [](float known, const End& end) -> End {
    if (known > 0) return {known, 1};
    return end.away == 0 || end.away >= gap_rim_reach ? End{0, 0}
                                                      : End{end.inverse_m, end.away + 1};
  };
  for (int y = 0; y < rows; ++y) {
    const int py = row(y);
    const std::uint8_t* const source = reconstruction.source.row(py);
    const float* const depth_m = reconstruction.depth_m.row(py);
    const std::uint8_t* const mask = occlusion.row(py);
    float* const known = known_.row(y);
    Node* const nodes = nodes_.row(y);
    for (int x = 0; x < columns; ++x) {
      const int px = column(x);
      if (!reconstruction.region.keeps(px, py)) {
        known[x] = not_looked_at;
      } else {
        known[x] = source[px] != 0 ? 1 / depth_m[px] : 0;
      }
      is_any_hidden = is_any_hidden || (known[x] == 0 && mask[px] != 0);
      nodes[x].inverse_m = 0;
      nodes[x].is_in_shadow = false;
    }
    End* const above = above_.row(y);
    if (y == 0) {
      std::fill_n(above, columns, End{0, 0});
      continue;
    }
    const float* const known_above = known_.row(y - 1);
    const End* const end = above_.row(y - 1);
    for (int x = 0; x < columns; ++x) above[x] = next_to(known_above[x], end[x]);
  }
  std::fill_n(below_.row(rows - 1), columns, End{0, 0});
  for (int y = rows - 2; y >= 0; --y) {
    const float* const known_below = known_.row(y + 1);
    const End* const end = below_.row(y + 1);
    End* const below = below_.row(y);
    for (int x = 0; x < columns; ++x) below[x] = next_to(known_below[x], end[x]);
  }
  return is_any_hidden;
}

/// Guesses along the row or column whose ends are more alike.
DepthGaps::Range DepthGaps::range_of(const End& left, const End& right, const End& above,
                                     const End& below) {
  Range range{std::numeric_limits<float>::max(), 0, 0};
  float least_difference = std::numeric_limits<float>::max();
  const auto add = [&](const End& a, const End& b) {
    for (const End* const end : {&a, &b}) {
      if (end->away == 0) continue;
      range.low = std::min(range.low, end->inverse_m);
      range.high = std::max(range.high, end->inverse_m);
    }
    const float difference = std::abs(a.inverse_m - b.inverse_m);
    if (a.away == 0 || b.away == 0 || difference >= least_difference) return;
    least_difference = difference;
    const auto to_a = static_cast<float>(a.away);
    const auto to_b = static_cast<float>(b.away);
    range.guess = (a.inverse_m * to_b + b.inverse_m * to_a) / (to_a + to_b);
  };
  add(left, right);
  add(above, below);
  range.low *= 1 - range_slack;
  range.high *= 1 + range_slack;
  return range;
}

DepthGaps::Node DepthGaps::look(const GapScene& scene, int x, int y, const Range& range) const {
  const Eigen::Vector3f ray = scene.views.ray(column(x), row(y));
  const auto px = static_cast<float>(column(x));
  const auto py = static_cast<float>(row(y));
  // A whole vector of them: those beyond the last are at 0, where nothing is.
  constexpr std::size_t in_vector = 8;
  std::array<float, in_vector> ray_x, ray_y, inverse_m, depth_m{};
  ray_x.fill(ray.x());
  ray_y.fill(ray.y());
  for (std::size_t i = 0; i < tried_depths; ++i) {
    const float share = static_cast<float>(i) / (tried_depths - 1);
    inverse_m[i] = range.low + share * (range.high - range.low);
    depth_m[i] = 1 / inverse_m[i];
  }
  const PointRow points{ray_x.data(), ray_y.data(), depth_m.data(), static_cast<int>(in_vector)};
  Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::max());
  Eigen::Array3f high = -low;
  Node node;
  float nearest = std::numeric_limits<float>::max();
  bool is_alike = true;
  int looks = 0;
  for (std::size_t k = 0; k < scene.views.size(); ++k) {
    scene.views.for_each_bare(k, points, [&](std::size_t i, const DepthView::Depth& bare) {
      const Eigen::Vector3f point_m = ray * depth_m[i];
      if (!is_alike || !scene.views.is_in_gap(k, bare)) return;
      const auto color = scene.views.color(k, point_m);
      if (!color) return;
      const Eigen::Array3f mapped = scene.color_maps[k + 1](*color, px, py);
      low = low.min(mapped);
      high = high.max(mapped);
      is_alike = (high - low).maxCoeff() <= same_color;
      ++looks;
      const float away = std::abs(inverse_m[i] - range.guess);
      if (away >= nearest) return;
      nearest = away;
      node = {mapped, inverse_m[i], k, false};
    });
  }
  return is_alike && looks >= fewest_looks ? node : Node{};
}

void DepthGaps::look_along_row(const GapScene& scene, int y) {
  const float* const known = known_.row(y);
  Node* const nodes = nodes_.row(y);
  const int columns = known_.width();
  // From the right end on: for each node what is to its right.
  End* const right = right_.row(y);
  End end{0, 0};
  const auto step_on = [&](int x) {
    if (known[x] > 0) {
      end = {known[x], 1};
    } else if (end.away != 0) {
      end = end.away >= gap_rim_reach ? End{0, 0} : End{end.inverse_m, end.away + 1};
    }
  };
  for (int x = columns - 1; x >= 0; --x) {
    right[x] = end;
    step_on(x);
  }
  end = {0, 0};
  for (int x = 0; x < columns; ++x) {
    if (known[x] == 0 && !nodes[x].is_in_shadow) {
      const Range range = range_of(end, right[x], above_(x, y), below_(x, y));
      if (range.guess > 0) nodes[x] = look(scene, x, y, range);
    }
    step_on(x);
  }
}

void DepthGaps::take_shadows(const GapScene& scene) {
  shadows_.for_each_node(part_, step_, [&](int x, int y, float inverse_m, std::size_t k) {
    Node& node = nodes_(x, y);
    if (known_(x, y) != 0 || node.inverse_m >= inverse_m) return;
    const int px = column(x);
    const int py = row(y);
    const auto color = scene.views.color(k, scene.views.ray(px, py) / inverse_m);
    if (!color) return;
    node = {scene.color_maps[k + 1](*color, static_cast<float>(px), static_cast<float>(py)),
            inverse_m, k, true};
  });
}

void DepthGaps::confirm(const GapScene& scene) {
  found_.resize(nodes_.width(), nodes_.height(), 0);
  for (int y = 0; y < nodes_.height(); ++y) {
    for (int x = 0; x < nodes_.width(); ++x) {
      if (!(nodes_(x, y).inverse_m > 0)) continue;
      found_.fill(intersect({x - 1, y - 1, 3, 3}, found_.bounds()), 255);
    }
  }
  regions_.find(found_, Pixels::set, Connectivity::eight);
  for (const ConnectedRegions::Region& region : regions_.regions()) {
    errors_.clear();
    const auto for_each_node = [&](const auto& visit) {
      regions_.for_each_run(region, [&](const ConnectedRegions::Run& run) {
        for (int x = run.first; x < run.last; ++x) {
          if (nodes_(x, run.y).inverse_m > 0) visit(x, run.y);
        }
      });
    };
    for_each_node([&](int x, int y) {
      if (scene.masks.color(column(x), row(y)) != 0) return;
      const Eigen::Array3f seen = to_channels(scene.frame.color(column(x), row(y)));
      errors_.push_back((nodes_(x, y).color - seen).abs().maxCoeff());
    });
    if (errors_.size() >= fewest_witnesses) {
      const auto middle = errors_.begin() + static_cast<std::ptrdiff_t>(errors_.size() / 2);
      std::nth_element(errors_.begin(), middle, errors_.end());
      if (*middle <= confirmed_error) continue;
    }
    for_each_node([&](int x, int y) {
      if (!nodes_(x, y).is_in_shadow) nodes_(x, y).inverse_m = 0;
    });
  }
}

void DepthGaps::draw_node(const GapScene& scene, const Node& node, const Rect& pixels,
                          Reconstruction& reconstruction) const {
  for (int y = pixels.y; y < pixels.bottom(); ++y) {
    for (int x = pixels.x; x < pixels.right(); ++x) {
      if (scene.masks.color(x, y) == 0 || !reconstruction.region.keeps(x, y) ||
          reconstruction.source(x, y) != 0) {
        continue;
      }
      const auto color = scene.views.color(node.camera, scene.views.ray(x, y) / node.inverse_m);
      if (!color) continue;
      const Bgr mapped = to_color(
          scene.color_maps[node.camera + 1](*color, static_cast<float>(x), static_cast<float>(y)));
      reconstruction.color(x, y) = {mapped.b, mapped.g, mapped.r, 255};
      reconstruction.depth_m(x, y) = 1 / node.inverse_m;
      reconstruction.source(x, y) = provenance::estimated;
    }
  }
}

void DepthGaps::draw(const GapScene& scene, const Rect& part, Reconstruction& reconstruction) {
  part_ = intersect(part, intersect(reconstruction.region, reconstruction.source.bounds()));
  if (part_.empty()) return;
  if (!find_known(scene.masks.color, reconstruction)) return;
  take_shadows(scene);
  for_row_groups(known_.height(), node_rows_together, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) look_along_row(scene, y);
  });
  confirm(scene);
  for_row_groups(nodes_.height(), node_rows_together, [&](Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
      for (int x = 0; x < nodes_.width(); ++x) {
        if (!(nodes_(x, y).inverse_m > 0)) continue;
        draw_node(scene, nodes_(x, y), intersect({column(x), row(y), step_, step_}, part_),
                  reconstruction);
      }
    }
  });
}

}  // namespace diminish
