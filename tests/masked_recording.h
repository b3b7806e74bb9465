#pragma once

#include <opencv2/imgproc.hpp>
#include <string>

#include "source/tiny_recording.h"

namespace diminish {

/// A tiny recording that runs: cameras side by side, and an object given by masks.
class MaskedRecording : public TinyRecording {
 public:
  MaskedRecording() {
    write("rig.yaml", rig());
    write("scene.yaml", "occluders: [{name: patch, detector: mask, color: masks/color}]\n");
    for (int i = 0; i < 3; ++i) {
      cv::Mat mask(30, 40, CV_8UC1, cv::Scalar(0));
      mask(cv::Rect(12, 9, 10, 8)).setTo(255);
      write("masks/color/" + std::to_string(i) + ".png", mask);
    }
  }

  std::string folder() const { return path("").string(); }
  std::string out() const { return path("out").string(); }

  static std::string rig() {
    return TinyRecording::rig() +
           "pose: {source: fixed, color_from_rgbd: {rgbd0: {rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1],"
           " translation: [0, 0, 0]}}}\n";
  }

  /// rig.yaml with one text replaced.
  void spoil_rig(const std::string& from, const std::string& to) const {
    std::string text = rig();
    text.replace(text.find(from), from.size(), to);
    write("rig.yaml", text);
  }
};

}  // namespace diminish
