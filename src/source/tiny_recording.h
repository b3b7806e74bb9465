#pragma once

#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "diminish/frame_source.h"
#include "temporary_folder.h"

namespace diminish {

/// A recording of three small frames at 10 Hz for tests to damage. Colour images: 40x30, with the
/// frame's number in blue. RGB-D camera rgbd0: 32x24, 1 ms later.
class TinyRecording {
 public:
  TinyRecording() {
    write("rig.yaml", rig());
    write("scene.yaml", "occluders: [{name: ball, detector: color_blob, training: training}]\n");
    for (const char* list : {"color", "rgbd0_color", "rgbd0_depth"}) write_list(list, {0, 1, 2});
    for (int i = 0; i < 3; ++i) {
      write(fmt::format("color/{}.png", i), cv::Mat(30, 40, CV_8UC3, cv::Scalar(i, 50, 200)));
      write(fmt::format("rgbd0_color/{}.png", i), cv::Mat(24, 32, CV_8UC3, cv::Scalar(i, 1, 2)));
      write(fmt::format("rgbd0_depth/{}.png", i), cv::Mat(24, 32, CV_16UC1, cv::Scalar(1000 + i)));
    }
  }

  static std::string rig() {
    return "color: {width: 40, height: 30, camera_matrix: [40, 40, 20, 15],"
           " distortion: [0, 0, 0, 0, 0]}\n"
           "rgbd:\n"
           "  - name: rgbd0\n"
           "    color: {width: 32, height: 24, camera_matrix: [30, 30, 16, 12],"
           " distortion: [0, 0, 0, 0, 0]}\n"
           "    depth: {width: 32, height: 24, camera_matrix: [30, 30, 16, 12],"
           " distortion: [0, 0, 0, 0, 0]}\n"
           "    depth_unit_m: 0.001\n"
           "    color_from_depth: {rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1],"
           " translation: [0, 0, 0]}\n";
  }

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  void write(const std::string& name, const cv::Mat& image) const {
    std::filesystem::create_directories(path(name).parent_path());
    if (!cv::imwrite(path(name).string(), image)) throw std::runtime_error("cannot write " + name);
  }
  /// Writes NAME.txt with these images of the folder NAME.
  void write_list(const std::string& name, const std::vector<int>& images) const {
    std::string text = "# timestamp filename\n";
    for (const int i : images) {
      const double stamp_s = 1000 + 0.1 * i + (name == "color" ? 0 : 0.001);
      text += fmt::format("{:.6f} {}/{}.png\n", stamp_s, name, i);
    }
    write(name + ".txt", text);
  }

  std::unique_ptr<FrameSource> open(const Options& options = {}) const {
    return open_recording(load_recording(folder_.path()), options);
  }
  /// All frames.
  std::vector<FrameSet> read(const Options& options = {}) const {
    const auto source = open(options);
    std::vector<FrameSet> frames(1);
    while (source->next(frames.back())) frames.emplace_back(frames.back());
    frames.pop_back();
    return frames;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace diminish
