#include "detect/articulated/joint_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/number_lines.h"
#include "diminish/error.h"

namespace diminish {

JointList JointList::load(const std::filesystem::path& file, std::size_t joints) {
  std::ifstream stream(file);
  if (!stream) {
    throw Error(Error::io, file.string() + ": cannot be read, expected a list of joint positions");
  }
  return read(stream, file, joints);
}

JointList JointList::read(std::istream& stream, const std::filesystem::path& file,
                          std::size_t joints) {
  JointList list;
  for_each_number_line(stream, file, [&](const std::vector<double>& numbers, const FailLine& fail) {
    if (numbers.size() != joints + 1) {
      fail(fmt::format("expected a timestamp and the positions of {} joints, got {} numbers",
                       joints, numbers.size()));
    }
    if (!list.moments_.empty() && !(numbers[0] > list.moments_.back().stamp_s)) {
      fail("expected ascending timestamps");
    }
    list.moments_.push_back({numbers[0], {numbers.begin() + 1, numbers.end()}});
  });
  if (list.moments_.empty()) {
    throw Error(Error::input, file.string() + ": expected at least one line of joint positions");
  }
  return list;
}

bool JointList::at(double stamp_s, double tolerance_s, std::vector<double>& positions) const {
  const auto after =
      std::lower_bound(moments_.begin(), moments_.end(), stamp_s,
                       [](const Moment& moment, double stamp) { return moment.stamp_s < stamp; });
  const Moment& second = after == moments_.end() ? moments_.back() : *after;
  const Moment& first = after == moments_.begin() ? second : *(after - 1);
  const double nearest =
      std::min(std::abs(stamp_s - first.stamp_s), std::abs(stamp_s - second.stamp_s));
  if (nearest > tolerance_s) return false;
  const double span_s = second.stamp_s - first.stamp_s;
  const double share = span_s > 0 ? std::clamp((stamp_s - first.stamp_s) / span_s, 0.0, 1.0) : 1.0;
  positions.resize(first.positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions[i] = (1 - share) * first.positions[i] + share * second.positions[i];
  }
  return true;
}

}  // namespace diminish
