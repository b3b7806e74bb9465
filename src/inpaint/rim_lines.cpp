#include "inpaint/rim_lines.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/bilinear.h"
#include "core/channels.h"

namespace diminish {
namespace {

/// Edges are looked for on a ring around the mask: further away than the first, up to the second.
constexpr int ring_begin = 3;
constexpr int ring_end = 6;
constexpr int longest = 160;  ///< pixels of an edge that are looked at
constexpr int shortest = 24;
/// Grey levels per pixel, of a picture blurred by a pixel: well above a camera's noise.
constexpr float least_contrast = 6;
/// An edge ends where its contrast falls below this share of what it was.
constexpr float least_share = 0.5F;
constexpr int step = 2;               ///< pixels from one point of an edge to the next
constexpr int search = 2;             ///< pixels to each side
constexpr int sampled = search + 2;   ///< pixels around a point that are looked at
constexpr int most_gaps = 1;          ///< steps in a row without an edge
constexpr float straightness = 0.6F;  ///< largest deviation, pixels, root mean square
constexpr int deepest = 14;           ///< the mask begins no further from the ring, along the line
constexpr int profile_length = 16;    ///< pixels along the line

Eigen::Vector2f across(const Eigen::Vector2f& direction) {
  return {-direction.y(), direction.x()};
}

}  // namespace

/// An edge while it is followed.
struct RimLines::Track {
  Eigen::Vector2f start, outward, normal;
  float contrast;  ///< at its start
  int points = 0;
  float contrasts = 0;  ///< their sum
  /// Sums over the points, relative to the start.
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  float rms = 0;
  Eigen::Vector2f middle;

  void add(const Eigen::Vector2f& point, float edge) {
    const Eigen::Vector2d p = (point - start).cast<double>();
    sum += p;
    squares += p * p.transpose();
    contrasts += edge;
    ++points;
  }
  /// The line through the points so far.
  void fit() {
    const Eigen::Vector2d mean = sum / points;
    const Eigen::Matrix2d spread = squares / points - mean * mean.transpose();
    const double angle = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
    Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    if (along.dot(outward.cast<double>()) < 0) along = -along;
    const double variance = spread.trace() - along.dot(spread * along);
    rms = static_cast<float>(std::sqrt(std::max(variance, 0.0)));
    middle = start + mean.cast<float>();
    outward = along.cast<float>();
    const Eigen::Vector2f side = across(outward);
    normal = side.dot(normal) > 0 ? side : Eigen::Vector2f(-side);
  }
};

/// Calls visit(first, last) for the runs of columns in a row of `box` that are on a ring around the
/// mask.
template <class Visit>
void RimLines::for_each_on_ring(int y, const Rect& box, const Visit& visit) {
  const auto join = [&](int reach, JoinedRuns& joined) {
    joined.clear();
    mask_runs_.for_each_near(y, reach, [&](const ColumnRun& run, int) {
      joined.add({run.first - reach, run.last + reach});
    });
  };
  join(ring_begin, near_);
  join(ring_end, around_);
  const auto clip_and_visit = [&](int first, int last) {
    first = std::max(first, box.x);
    last = std::min(last, box.right());
    if (first < last) visit(first, last);
  };
  // What is near is around, too.
  auto near = near_.in_order().begin();
  for (const ColumnRun& around : around_.in_order()) {
    int first = around.first;
    for (; near != near_.runs().end() && near->last <= around.last; ++near) {
      clip_and_visit(first, near->first);
      first = near->last;
    }
    clip_and_visit(first, around.last);
  }
}

/// In grey levels per pixel. x, y: in `part_`, not at its border.
Eigen::Vector2f RimLines::gradient(int x, int y) const {
  const std::uint16_t* const above = grey_.row(y - 1) + x;
  const std::uint16_t* const here = grey_.row(y) + x;
  const std::uint16_t* const below = grey_.row(y + 1) + x;
  const int across = above[1] - above[-1] + below[1] - below[-1] + 2 * (here[1] - here[-1]);
  const int down = below[-1] - above[-1] + below[1] - above[1] + 2 * (below[0] - above[0]);
  return Eigen::Vector2f(static_cast<float>(across), static_cast<float>(down)) /
         (8 * BlurredGrey::scale);
}

// All positions below are in the picture.

float RimLines::level(const Eigen::Vector2f& at) const {
  const auto level = [&](int x, int y) { return static_cast<float>(grey_(x, y)); };
  return bilinear(at.x() - static_cast<float>(part_.x), at.y() - static_cast<float>(part_.y),
                  level) /
         BlurredGrey::scale;
}

/// Whether all that is sampled around a position is known.
bool RimLines::is_inside(const Eigen::Vector2f& at) const {
  constexpr float margin = sampled;
  return at.x() >= static_cast<float>(part_.x) + margin &&
         at.y() >= static_cast<float>(part_.y) + margin &&
         at.x() < static_cast<float>(part_.right()) - margin - 1 &&
         at.y() < static_cast<float>(part_.bottom()) - margin - 1;
}

bool RimLines::is_hidden(const Eigen::Vector2f& at) const {
  return (*occlusion_)(static_cast<int>(std::lrint(at.x())),
                       static_cast<int>(std::lrint(at.y()))) != 0;
}

/// Whether an edge that runs into the mask passes through this pixel of `part_`, whose surroundings
/// have been looked at.
bool RimLines::start(int x, int y, Track& track) {
  const Eigen::Vector2f slope = gradient(x, y);
  const float contrast = slope.norm();
  if (contrast < least_contrast) return false;
  track.normal = slope / contrast;
  track.contrast = contrast;
  track.start = Eigen::Vector2f(static_cast<float>(part_.x + x), static_cast<float>(part_.y + y));
  if (!is_inside(track.start)) return false;
  // The steepest across the edge.
  const auto steepness = [&](float shift) {
    const Eigen::Vector2f at = track.start + shift * track.normal;
    return level(at + track.normal) - level(at - track.normal);
  };
  const float own = steepness(0);
  if (steepness(-1) > own || steepness(1) > own) return false;
  track.outward = across(track.normal);
  const auto runs_into_mask = [&](float sign) {
    for (int k = 1; k <= deepest; ++k) {
      const Eigen::Vector2f at = track.start + sign * static_cast<float>(k) * track.outward;
      if (!is_inside(at)) return false;
      if (is_hidden(at)) return true;
    }
    return false;
  };
  const bool forward = runs_into_mask(1);
  if (forward == runs_into_mask(-1)) return false;
  if (forward) track.outward = -track.outward;
  return true;
}

/// Follows an edge away from the mask, as long as it is straight.
bool RimLines::follow(Track& track) {
  constexpr int positions = 2 * search + 3;
  Eigen::Vector2f base = track.start;
  int gaps = 0;
  int length = 0;
  for (int k = 0; k <= longest; k += step) {
    const Eigen::Vector2f at = base + static_cast<float>(k) * track.outward;
    if (!is_inside(at) || is_hidden(at)) break;
    grey_.look_at(grow(
        {static_cast<int>(at.x()) - part_.x, static_cast<int>(at.y()) - part_.y, 2, 2}, sampled));
    std::array<float, positions> levels;
    for (int i = 0; i < positions; ++i) {
      levels[static_cast<std::size_t>(i)] =
          level(at + static_cast<float>(i - search - 1) * track.normal);
    }
    std::array<float, positions> steepness{};
    std::size_t best = 1;
    for (std::size_t i = 1; i + 1 < positions; ++i) {
      steepness[i] = (levels[i + 1] - levels[i - 1]) / 2;
      if (steepness[i] > steepness[best]) best = i;
    }
    if (best == 1 || best == positions - 2 || steepness[best] < least_share * track.contrast) {
      if (++gaps > most_gaps) break;
      continue;
    }
    gaps = 0;
    length = k;
    const float bend = steepness[best - 1] - 2 * steepness[best] + steepness[best + 1];
    const float shift = bend < 0 ? (steepness[best - 1] - steepness[best + 1]) / (2 * bend) : 0;
    track.add(at + (static_cast<float>(best) - search - 1 + shift) * track.normal, steepness[best]);
    if (track.points >= 5 && track.points % 2 == 1) {
      track.fit();
      base = track.middle + track.outward * track.outward.dot(track.start - track.middle);
    }
  }
  if (length < shortest || step * track.points < shortest) return false;
  track.fit();
  return track.rms <= straightness;
}

/// Whether there is this line already.
bool RimLines::is_known(const RimLine& line) const {
  return std::any_of(lines_.begin(), lines_.end(), [&](const RimLine& other) {
    const Eigen::Vector2f between = line.entry - other.entry;
    return std::abs(between.dot(other.normal)) < 2 && std::abs(between.dot(other.outward)) < 30 &&
           line.outward.dot(other.outward) > 0.99F && line.normal.dot(other.normal) > 0;
  });
}

bool RimLines::collect_profile(ImageView<Bgr> picture, RimLine& line) const {
  for (int i = 0; i < RimLine::profile_size; ++i) {
    Eigen::Array3f sum = Eigen::Array3f::Zero();
    int count = 0;
    for (int k = 1; k <= profile_length; ++k) {
      const Eigen::Vector2f at = line.entry + static_cast<float>(k) * line.outward +
                                 static_cast<float>(i - RimLine::half_width) * line.normal;
      const int x = static_cast<int>(std::lrint(at.x()));
      const int y = static_cast<int>(std::lrint(at.y()));
      if (!picture.bounds().contains(x, y) || (*occlusion_)(x, y) != 0) continue;
      sum += to_channels(picture(x, y));
      ++count;
    }
    if (count == 0) return false;
    line.profile[static_cast<std::size_t>(i)] = sum / static_cast<float>(count);
  }
  return true;
}

void RimLines::find(ImageView<Bgr> picture, const Mask& occlusion, const Rect& objects) {
  lines_.clear();
  occlusion_ = &occlusion;
  part_ = intersect(grow(objects, ring_end + longest), picture.bounds());
  if (part_.empty()) return;
  grey_.begin(picture, part_);
  mask_runs_.find(occlusion, intersect(objects, picture.bounds()), Pixels::set);
  const Rect inner = intersect(grow(objects, ring_end), grow(part_, -1));
  for (int y = inner.y; y < inner.bottom(); ++y) {
    const auto try_from = [&](int x) {
      Track track;
      if (!start(x - part_.x, y - part_.y, track)) return;
      RimLine line;
      line.entry = track.start;
      line.outward = track.outward;
      line.normal = track.normal;
      if (!follow(track)) return;
      line.outward = track.outward;
      line.normal = track.normal;
      line.contrast = track.contrasts / static_cast<float>(track.points);
      line.length = step * track.points;
      line.entry = track.middle + track.outward * track.outward.dot(track.start - track.middle);
      for (int k = 0; k < deepest && !is_hidden(line.entry - line.outward); ++k) {
        line.entry -= line.outward;
      }
      if (!is_known(line) && collect_profile(picture, line)) lines_.push_back(line);
    };
    for_each_on_ring(y, inner, [&](int first, int last) {
      grey_.look_at(grow({first - part_.x, y - part_.y, last - first, 1}, sampled));
      for (int x = first; x < last; ++x) try_from(x);
    });
  }
  // Ends with what tells any two lines apart, so that the order does not depend on the library.
  std::sort(lines_.begin(), lines_.end(), [](const RimLine& a, const RimLine& b) {
    return std::tuple(b.strength(), a.entry.y(), a.entry.x()) <
           std::tuple(a.strength(), b.entry.y(), b.entry.x());
  });
  if (lines_.size() > most) lines_.resize(most);
}

}  // namespace diminish
