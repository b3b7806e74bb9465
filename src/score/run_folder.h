#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "diminish/rigid_transform.h"

namespace diminish {

/// A recording and the results of a run on it, as files to compare.
class RunFolder {
 public:
  /// Throws Error if there is no truth/background, or no run.
  RunFolder(std::filesystem::path recording, std::filesystem::path run);

  /// The frames of frames.csv, skipped ones too: those have no result.
  const std::vector<std::string>& frames() const { return frames_; }
  /// Frames with truth that are not among them.
  const std::vector<std::string>& not_written() const { return not_written_; }
  int mask_margin_px() const { return mask_margin_px_; }

  // 8-bit BGR, or one channel for masks; an empty matrix where the file is not there.
  cv::Mat input(const std::string& frame) const;
  cv::Mat truth(const std::string& frame) const;
  cv::Mat true_mask(const std::string& frame) const;
  cv::Mat result(const std::string& frame) const;
  cv::Mat mask(const std::string& frame) const;
  cv::Mat provenance(const std::string& frame) const;

  /// Where the object of a mask and its surroundings are; everything without an object.
  static cv::Rect surroundings(const cv::Mat& mask);
  /// The surroundings of the object, cut out of a frame's pictures.
  struct ObjectPictures {
    cv::Mat input, result, truth;
  };
  /// Nothing where a picture or the mask is missing.
  std::optional<ObjectPictures> object_pictures(const std::string& frame) const;

  using NamedPoses = std::map<std::string, RigidTransform>;
  /// The run's poses, by the names of frames.csv's columns.
  NamedPoses poses(const std::string& frame) const;
  /// The true ones, by the same names; empty where there are none.
  NamedPoses true_poses(const std::string& frame) const;

 private:
  void read_frames();
  void read_summary();
  void read_true_poses();
  void read_inputs();
  std::filesystem::path find(const std::filesystem::path& folder, const std::string& stem) const;

  std::filesystem::path recording_, run_;
  std::vector<std::string> frames_, not_written_;
  std::map<std::string, NamedPoses> poses_, true_poses_;
  std::map<std::string, std::filesystem::path> inputs_;
  int mask_margin_px_ = 0;
};

}  // namespace diminish
