#include "pose/pose_list.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "core/limits.h"
#include "core/number_lines.h"
#include "diminish/error.h"

namespace diminish {

std::vector<StampedPose> load_pose_list(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Error(Error::io, file.string() + ": cannot be read, expected a list of poses");
  return read_pose_list(stream, file);
}

std::vector<StampedPose> read_pose_list(std::istream& stream, const std::filesystem::path& file) {
  std::vector<StampedPose> poses;
  for_each_number_line(stream, file, [&](const std::vector<double>& v, const FailLine& fail) {
    if (v.size() != 8) fail("expected 'timestamp tx ty tz qx qy qz qw'");
    const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
    if (std::abs(rotation.norm() - 1) > 1e-2) fail("expected a quaternion of length 1");
    if (std::any_of(v.begin() + 1, v.begin() + 4,
                    [](double t) { return std::abs(t) > largest_coordinate_m; })) {
      fail("expected metres, got more than a kilometre");
    }
    if (!poses.empty() && !(v[0] > poses.back().stamp_s)) fail("expected ascending timestamps");
    poses.push_back({v[0], {rotation.normalized().toRotationMatrix(), {v[1], v[2], v[3]}}});
  });
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
