#include "ros/transform_buffer.h"

#include <algorithm>

#include "ros/frame_tree.h"

namespace diminish::ros {
namespace {

constexpr std::size_t most_frames = 1000;
constexpr std::size_t most_moments = 512;
constexpr double kept_s = 10;

RigidTransform between(const RigidTransform& a, const RigidTransform& b, double share) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(a.rotation).slerp(share, Eigen::Quaterniond(b.rotation));
  return {rotation.toRotationMatrix(), a.translation + share * (b.translation - a.translation)};
}

}  // namespace

TransformBuffer::Frame* TransformBuffer::frame_of(const TransformStamped& transform) {
  const std::string child = plain_frame(transform.child);
  if (frames_.size() >= most_frames && !frames_.contains(child)) return nullptr;
  Frame& frame = frames_[child];
  std::string parent = plain_frame(transform.header.frame_id);
  if (frame.parent != parent) {
    frame = {};
    frame.parent = std::move(parent);
  }
  return &frame;
}

void TransformBuffer::add_static(const TfMessage& message) {
  for (const TransformStamped& transform : message.transforms) {
    Frame* const frame = frame_of(transform);
    if (!frame) continue;
    frame->is_static = true;
    frame->moments = {{0, transform.parent_from_child}};
  }
}

void TransformBuffer::add(const TfMessage& message, double offset_s) {
  for (const TransformStamped& transform : message.transforms) {
    Frame* const frame = frame_of(transform);
    if (!frame) continue;
    auto& moments = frame->moments;
    if (frame->is_static) moments.clear();
    frame->is_static = false;
    const Moment moment{transform.header.stamp_s + offset_s, transform.parent_from_child};
    if (!moments.empty() && moment.time_s < moments.back().time_s - kept_s) moments.clear();
    auto place =
        std::lower_bound(moments.begin(), moments.end(), moment.time_s,
                         [](const Moment& known, double time) { return known.time_s < time; });
    if (place != moments.end() && place->time_s == moment.time_s) {
      *place = moment;
      continue;
    }
    moments.insert(place, moment);
    const double oldest_s = moments.back().time_s - kept_s;
    std::size_t old = moments.size() > most_moments ? moments.size() - most_moments : 0;
    while (moments[old].time_s < oldest_s) ++old;
    moments.erase(moments.begin(), moments.begin() + static_cast<std::ptrdiff_t>(old));
  }
}

TransformBuffer::Found TransformBuffer::find(const std::string& to, const std::string& from,
                                             double time_s, double most_gap_s) const {
  Found found;
  const auto fail = [&](Found::Kind kind, const std::string& frame, double newest_s) {
    if (found.kind != Found::Kind::unknown) return;  // the first one is told
    found.kind = kind;
    found.frame = frame;
    found.newest_s = newest_s;
  };
  // The way up from each of the two, as far as it goes.
  const auto way_up = [&](const std::string& start) {
    std::vector<std::string> way = {plain_frame(start)};
    while (way.size() <= frames_.size()) {
      const auto frame = frames_.find(way.back());
      if (frame == frames_.end()) break;
      way.push_back(frame->second.parent);
    }
    return way;
  };
  const std::vector<std::string> up_from = way_up(from);
  const std::vector<std::string> up_to = way_up(to);
  const auto common =
      std::find_first_of(up_from.begin(), up_from.end(), up_to.begin(), up_to.end());
  if (common == up_from.end()) return found;
  /// Along a way, up to the common frame.
  const auto along = [&](const std::vector<std::string>& way) {
    RigidTransform common_from_start;
    for (const std::string& name : way) {
      if (name == *common) break;
      const Frame& frame = frames_.at(name);
      const auto& moments = frame.moments;
      const auto after =
          frame.is_static
              ? moments.begin()
              : std::lower_bound(moments.begin(), moments.end(), time_s,
                                 [](const Moment& m, double time) { return m.time_s < time; });
      RigidTransform parent_from_child;
      if (after == moments.end()) {
        fail(Found::Kind::not_yet, name, moments.empty() ? 0 : moments.back().time_s);
        break;
      }
      if (frame.is_static || after->time_s == time_s) {
        parent_from_child = after->parent_from_child;
      } else if (after == moments.begin() || after->time_s - (after - 1)->time_s > most_gap_s) {
        fail(Found::Kind::lost, name, 0);
        break;
      } else {
        const Moment& before = *(after - 1);
        parent_from_child = between(before.parent_from_child, after->parent_from_child,
                                    (time_s - before.time_s) / (after->time_s - before.time_s));
      }
      common_from_start = parent_from_child * common_from_start;
    }
    return common_from_start;
  };
  const RigidTransform common_from_from = along(up_from);
  const RigidTransform common_from_to = along(up_to);
  if (found.kind != Found::Kind::unknown) return found;
  found.kind = Found::Kind::known;
  found.to_from_from = common_from_to.inverse() * common_from_from;
  return found;
}

}  // namespace diminish::ros
