#include "inpaint/line_painting.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/channels.h"
#include "core/rows.h"
#include "core/runs.h"

namespace diminish {
namespace {

constexpr float half_width = RimLine::half_width;
constexpr float feather = 3;           ///< pixels at each side over which a line fades
constexpr float side_by_side = 0.98F;  ///< cosine between their normals
constexpr float before =
    12;  ///< pixels that are painted before a stroke's start: it may enter at an angle

// Two ends of one edge:
constexpr float same_direction = 0.985F;  ///< cosine
/// The one lies on the other's line, but for this many pixels and this share of their distance.
constexpr float offset_px = 2;
constexpr float offset_share = 0.04F;
constexpr float shortest_join = 8;  ///< pixels
constexpr float contrast_ratio = 2;
constexpr float color_difference = 40;  ///< levels, the mean over both profiles

// One end alone:
constexpr float reach = 2.5F;       ///< times its length outside
constexpr float fading = 0.25F;     ///< the share of that over which it fades
constexpr int most_seen = 12;       ///< pixels in a row that it may cross
constexpr int measured_depth = 12;  ///< pixels outside where is asked what it belongs to
constexpr float measured_side = 4;  ///< pixels beside it
/// Its colours are half those outside, half the smooth filling's with only its contrast.
constexpr float own_colors = 0.5F;

constexpr int rows_together = 32;

std::uint8_t label_at(const Surfaces& surfaces, int x, int y) {
  if (!surfaces.region.contains(x, y) || !surfaces.label.bounds().contains(x, y)) {
    return surface_label::unknown;
  }
  return surfaces.label(x, y);
}
std::uint8_t label_at(const Surfaces& surfaces, const Eigen::Vector2f& at) {
  return label_at(surfaces, static_cast<int>(std::lrint(at.x())),
                  static_cast<int>(std::lrint(at.y())));
}

/// Whether something in front of the planes was measured beside the line.
bool bounds_foreground(const RimLine& line, const Surfaces& surfaces) {
  for (const float side : {-measured_side, measured_side}) {
    int count = 0;
    for (int k = 1; k <= measured_depth; ++k) {
      const Eigen::Vector2f at =
          line.entry + static_cast<float>(k) * line.outward + side * line.normal;
      count += label_at(surfaces, at) == surface_label::foreground ? 1 : 0;
    }
    if (2 * count >= measured_depth) return true;
  }
  return false;
}

/// Between two entries.
template <class Profile>
Eigen::Array4f profile_at(const Profile& profile, float position) {
  const auto i = static_cast<std::size_t>(position);
  const float share = position - static_cast<float>(i);
  return profile[i] + share * (profile[i + 1] - profile[i]);
}

}  // namespace

void LinePainting::match(std::span<const RimLine> lines) {
  pairs_.clear();
  mates_.assign(lines.size(), -1);
  const int count = static_cast<int>(lines.size());
  for (int i = 0; i < count; ++i) {
    const RimLine& a = lines[static_cast<std::size_t>(i)];
    for (int k = i + 1; k < count; ++k) {
      const RimLine& b = lines[static_cast<std::size_t>(k)];
      if (a.outward.dot(b.outward) > -same_direction || a.normal.dot(b.normal) < same_direction) {
        continue;
      }
      const Eigen::Vector2f between = b.entry - a.entry;
      const float apart = -between.dot(a.outward);
      const float most = offset_px + offset_share * apart;
      const float offset_a = std::abs(between.dot(a.normal));
      const float offset_b = std::abs(between.dot(b.normal));
      if (apart < shortest_join || offset_a > most || offset_b > most) continue;
      const float ratio = a.contrast / b.contrast;
      if (ratio > contrast_ratio || ratio * contrast_ratio < 1) continue;
      float difference = 0;
      for (std::size_t s = 0; s < a.profile.size(); ++s) {
        difference += (a.profile[s] - b.profile[s]).abs().mean();
      }
      difference /= RimLine::profile_size;
      if (difference > color_difference) continue;
      pairs_.push_back({(offset_a + offset_b) / most + 2 * difference / color_difference, i, k});
    }
  }
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.misfit, a.first, a.second) < std::tie(b.misfit, b.first, b.second);
  });
  for (const Pair& pair : pairs_) {
    int& first = mates_[static_cast<std::size_t>(pair.first)];
    int& second = mates_[static_cast<std::size_t>(pair.second)];
    if (first >= 0 || second >= 0) continue;
    first = pair.second;
    second = pair.first;
  }
}

/// The colours of a line that joins another, or what a line that just ends adds to its share of the
/// smooth filling's.
LinePainting::Profile LinePainting::colors_of(const RimLine& line, bool joins) {
  const auto& profile = line.profile;
  constexpr std::size_t last = RimLine::profile_size - 1;
  const Eigen::Array3f dark = (profile[0] + profile[1] + profile[2]) / 3;
  const Eigen::Array3f bright = (profile[last] + profile[last - 1] + profile[last - 2]) / 3;
  Profile colors;
  for (std::size_t i = 0; i <= last; ++i) {
    const Eigen::Array3f without = dark + static_cast<float>(i) / last * (bright - dark);
    colors[i].head<3>() = profile[i] - (joins ? 0 : 1 - own_colors) * without;
    colors[i][3] = 0;
  }
  return colors;
}

/// How far a line runs into the mask that has no second end.
float LinePainting::free_length(const RimLine& line, const Holes& holes) const {
  const int most = static_cast<int>(reach * static_cast<float>(line.length));
  int seen = 0;
  int on_other_plane = 0;
  std::uint8_t plane = surface_label::unknown;
  for (int k = 1; k <= most; ++k) {
    const Eigen::Vector2f at = line.entry - static_cast<float>(k) * line.outward;
    const int x = static_cast<int>(std::lrint(at.x()));
    const int y = static_cast<int>(std::lrint(at.y()));
    if (!holes.occlusion.bounds().contains(x, y) || holes.occlusion(x, y) == 0) {
      return static_cast<float>(k);
    }
    seen = holes.missing(x, y) != 0 ? 0 : seen + 1;
    if (seen > most_seen) return static_cast<float>(k - seen);
    const std::uint8_t label = label_at(holes.surfaces, x, y);
    if (label == surface_label::unknown || label == surface_label::foreground) continue;
    if (plane == surface_label::unknown) plane = label;
    on_other_plane = label == plane ? 0 : on_other_plane + 1;
    if (on_other_plane > most_seen) return static_cast<float>(k - on_other_plane);
  }
  return static_cast<float>(most);
}

void LinePainting::lay_out(const Holes& holes) {
  const std::span<const RimLine> lines = holes.lines;
  strokes_.clear();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const RimLine& line = lines[i];
    if (mates_[i] >= 0) {
      const auto mate = static_cast<std::size_t>(mates_[i]);
      if (mate < i) continue;
      const Eigen::Vector2f between = lines[mate].entry - line.entry;
      const float length = between.norm();
      const Eigen::Vector2f along = between / length;
      Eigen::Vector2f normal(-along.y(), along.x());
      if (normal.dot(line.normal) < 0) normal = -normal;
      strokes_.push_back({&line, &lines[mate], line.entry, along, normal, length});
      strokes_.back().end_colors = colors_of(lines[mate], true);
      strokes_.back().begin_colors = colors_of(line, true);
      continue;
    }
    if (bounds_foreground(line, holes.surfaces)) continue;
    const float length = free_length(line, holes);
    if (length < 2) continue;
    strokes_.push_back({&line, nullptr, line.entry, -line.outward, line.normal, length});
    strokes_.back().begin_colors = colors_of(line, false);
  }
  for (Stroke& stroke : strokes_) {
    stroke.has_company = std::any_of(strokes_.begin(), strokes_.end(), [&](const Stroke& other) {
      return &other != &stroke && are_company(stroke, other);
    });
  }
}

/// Calls visit(x, y, across) for the missing pixels of a part that are no further than `width` from
/// a stroke; across: how far, along its normal.
template <class Visit>
void LinePainting::for_each_beside(const Stroke& stroke, float width, const Rect& part,
                                   const Mask& missing, const Visit& visit) {
  const float after = stroke.end != nullptr ? before : 0;
  const Eigen::Vector2f from = stroke.start - before * stroke.along;
  const Eigen::Vector2f to = stroke.start + (stroke.length + after) * stroke.along;
  const bool steep = std::abs(stroke.along.y()) > std::abs(stroke.along.x());
  const int main = steep ? 1 : 0;
  const int side = 1 - main;
  const int low[] = {part.x, part.y};
  const int high[] = {part.right(), part.bottom()};
  const float slope = stroke.along[side] / stroke.along[main];
  const float wide = width / std::abs(stroke.along[main]);
  const float margin = width * std::abs(stroke.along[side]);
  float least = std::min(from[main], to[main]) - margin;
  float most = std::max(from[main], to[main]) + margin;
  constexpr float level = 1e-3F;
  if (std::abs(slope) > level) {
    // Where it passes the part.
    const auto pass = [&](float at) {
      return stroke.start[main] + (at - stroke.start[side]) / slope;
    };
    const float one = pass(static_cast<float>(low[side]) - wide - 1);
    const float other = pass(static_cast<float>(high[side]) + wide + 1);
    least = std::max(least, std::min(one, other));
    most = std::min(most, std::max(one, other));
  }
  const int first = std::max(low[main], static_cast<int>(std::floor(least)));
  const int last = std::min(high[main] - 1, static_cast<int>(std::ceil(most)));
  for (int i = first; i <= last; ++i) {
    const float ahead = static_cast<float>(i) - stroke.start[main];
    const float own_along = ahead * stroke.along[main];
    const float own_across = ahead * stroke.normal[main];
    const float centre = stroke.start[side] + slope * ahead;
    const int begin = std::max(low[side], static_cast<int>(std::ceil(centre - wide)));
    const int end = std::min(high[side] - 1, static_cast<int>(std::floor(centre + wide)));
    if (begin > end) continue;
    const std::uint8_t* at = steep ? missing.row(i) + begin : missing.row(begin) + i;
    const std::ptrdiff_t next = steep ? 1 : missing.width();
    for (int k = begin; k <= end; ++k, at += next) {
      if (*at == 0) continue;
      const int x = steep ? k : i;
      const int y = steep ? i : k;
      const float beside = static_cast<float>(k) - stroke.start[side];
      const float along = own_along + beside * stroke.along[side];
      if (along < -before || along > stroke.length + after) continue;
      visit(x, y, own_across + beside * stroke.normal[side]);
    }
  }
}

/// Whether a pixel may lie beside both strokes, and these run side by side.
bool LinePainting::are_company(const Stroke& a, const Stroke& b) {
  if (std::abs(a.normal.dot(b.normal)) < side_by_side) return false;
  // Beyond its end a stroke may be wider yet.
  constexpr float wide = 2 * half_width + feather;
  const float slack = wide + std::sqrt(1 - side_by_side * side_by_side) * (b.length + 2 * before);
  return std::abs((b.start - a.start).dot(a.normal)) <= slack;
}

/// Gives each pixel of a part that is beside a stroke to the nearest one.
void LinePainting::claim(const Mask& missing, const Surfaces& surfaces, const Rect& part) {
  for (std::size_t i = 0; i < strokes_.size(); ++i) {
    const float handicap = strokes_[i].end != nullptr ? 0.F : 1.F;
    for_each_beside(strokes_[i], half_width, part, missing, [&](int x, int y, float across) {
      std::uint8_t& nearest = nearest_(x - objects_.x, y - objects_.y);
      Claim& claim = claims_(x - objects_.x, y - objects_.y);
      const float distance = std::abs(across) + handicap;
      if (nearest != 0 && distance >= claim.distance) return;
      // A line runs on behind a thing, not over its side.
      if (label_at(surfaces, x, y) == surface_label::standing) return;
      nearest = static_cast<std::uint8_t>(1 + i);
      claim = {distance, false};
    });
  }
  for (const Stroke& stroke : strokes_) {
    if (!stroke.has_company) continue;
    for_each_beside(stroke, half_width + feather, part, missing, [&](int x, int y, float across) {
      const std::uint8_t number = nearest_(x - objects_.x, y - objects_.y);
      if (number == 0) return;
      const Stroke& nearest = strokes_[number - 1U];
      if (&nearest == &stroke) return;
      const float turned = stroke.normal.dot(nearest.normal);
      if (std::abs(turned) < side_by_side) return;
      const Eigen::Vector2f pixel(static_cast<float>(x), static_cast<float>(y));
      claims_(x - objects_.x, y - objects_.y).is_between |=
          across * (pixel - nearest.start).dot(nearest.normal) * turned < 0;
    });
  }
}

/// column, row: in the objects' box.
void LinePainting::color(int column, int row, Bgr& pixel) const {
  const Claim& claim = claims_(column, row);
  const Stroke& stroke = strokes_[nearest_(column, row) - 1U];
  const Eigen::Vector2f offset = Eigen::Vector2f(static_cast<float>(objects_.x + column),
                                                 static_cast<float>(objects_.y + row)) -
                                 stroke.start;
  const float across = std::clamp(offset.dot(stroke.normal), -half_width, half_width);
  const float position = std::min(across + half_width, 2 * half_width - 0.001F);
  float weight =
      claim.is_between ? 1.F : std::clamp((half_width - std::abs(across)) / feather, 0.F, 1.F);
  const Eigen::Array4f smooth(pixel.b, pixel.g, pixel.r, 0);
  Eigen::Array4f color = profile_at(stroke.begin_colors, position);
  if (stroke.end != nullptr) {
    const float share = std::clamp(offset.dot(stroke.along) / stroke.length, 0.F, 1.F);
    color += share * (profile_at(stroke.end_colors, position) - color);
  } else {
    color += (1 - own_colors) * smooth;
    const float whole = reach * static_cast<float>(stroke.begin->length);
    weight *= std::clamp((1 - offset.dot(stroke.along) / whole) / fading, 0.F, 1.F);
  }
  pixel = to_color((smooth + weight * (color - smooth)).head<3>());
}

void LinePainting::paint(const Holes& holes, const Rect& objects, Image<Bgr>& picture) {
  match(holes.lines);
  lay_out(holes);
  if (strokes_.empty()) return;
  objects_ = objects;
  nearest_.resize(objects.width, objects.height, 0);
  claims_.resize(objects.width, objects.height);
  for_row_groups(objects.height, rows_together, [&](Rows rows) {
    claim(holes.missing, holes.surfaces,
          {objects.x, objects.y + rows.first, objects.width, rows.last - rows.first});
    for (int row = rows.first; row < rows.last; ++row) {
      Bgr* const pixels = picture.row(objects.y + row) + objects.x;
      for_each_set(nearest_.row(row), objects.width,
                   [&](int column) { color(column, row, pixels[column]); });
    }
  });
}

}  // namespace diminish
