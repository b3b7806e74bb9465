#pragma once

#include <cstddef>
#include <filesystem>
#include <istream>
#include <vector>

namespace diminish {

/// The positions of a chain's joints over time, as a robot's controller writes them down.
class JointList {
 public:
  /// Reads "timestamp position .." per line, one position for each joint, radians or metres; '#'
  /// starts a comment, timestamps ascend. Throws Error with file and line.
  static JointList load(const std::filesystem::path& file, std::size_t joints);
  static JointList read(std::istream& stream, const std::filesystem::path& file,
                        std::size_t joints);

  /// Between two moments of the list the positions change evenly. False if the list says nothing
  /// within `tolerance_s` of the moment.
  bool at(double stamp_s, double tolerance_s, std::vector<double>& positions) const;

 private:
  struct Moment {
    double stamp_s;
    std::vector<double> positions;
  };
  std::vector<Moment> moments_;
};

}  // namespace diminish
