#include "pose/pose_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include "core/text.h"
#include "diminish/error.h"

namespace diminish {

std::vector<StampedPose> load_pose_list(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Error(Error::io, file.string() + ": cannot be read, expected a list of poses");
  return read_pose_list(stream, file);
}

std::vector<StampedPose> read_pose_list(std::istream& stream, const std::filesystem::path& file) {
  std::vector<StampedPose> poses;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto fail = [&](const char* what) {
      throw Error(Error::input, fmt::format("{}:{}: {}", file.string(), number, what));
    };
    line.erase(std::find(line.begin(), line.end(), '#'), line.end());
    std::istringstream fields(line);
    std::array<double, 8> v{};
    std::string text;
    std::size_t count = 0;
    while (fields >> text) {
      const std::optional<double> value = parse_number(text);
      if (!value) fail("expected a finite number");
      if (count < v.size()) v[count] = *value;
      ++count;
    }
    if (count == 0) continue;
    if (count != v.size()) fail("expected 'timestamp tx ty tz qx qy qz qw'");
    const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
    if (std::abs(rotation.norm() - 1) > 1e-2) fail("expected a quaternion of length 1");
    if (!poses.empty() && !(v[0] > poses.back().stamp_s)) fail("expected ascending timestamps");
    poses.push_back({v[0], {rotation.normalized().toRotationMatrix(), {v[1], v[2], v[3]}}});
  }
  if (poses.empty()) throw Error(Error::input, file.string() + ": expected at least one pose");
  return poses;
}

const StampedPose* find_nearest(const std::vector<StampedPose>& poses, double stamp_s,
                                double tolerance_s) {
  const auto distance = [stamp_s](const StampedPose& pose) {
    return std::abs(pose.stamp_s - stamp_s);
  };
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), stamp_s,
                       [](const StampedPose& pose, double stamp) { return pose.stamp_s < stamp; });
  const StampedPose* nearest = after != poses.end() ? &*after : nullptr;
  if (after != poses.begin() && (!nearest || distance(*(after - 1)) < distance(*nearest))) {
    nearest = &*(after - 1);
  }
  return nearest && distance(*nearest) <= tolerance_s ? nearest : nullptr;
}

}  // namespace diminish
