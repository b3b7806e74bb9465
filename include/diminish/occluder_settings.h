#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "diminish/export.h"
#include "diminish/rigid_transform.h"
#include "diminish/scene.h"

namespace diminish {

/// For the detector `marker`: an object with a marker on it, whose shape in the marker's frame is
/// known.
class DIMINISH_EXPORT MarkerSettings : public OccluderSettings {
 public:
  MarkerSpec marker;
  /// At least 4, in metres. Without triangles, the shape is their convex hull.
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;  ///< indices of vertices
  /// A Wavefront OBJ file with the shape instead; empty: none.
  std::filesystem::path mesh;

  void check(const Config& place, const Rig* rig) const override;
  std::optional<MarkerSpec> marker_on_it() const override { return marker; }
  std::vector<std::filesystem::path> files() const override;
};

/// For the detector `color_blob`: an object that is found by its colour.
class DIMINISH_EXPORT ColorBlobSettings : public OccluderSettings {
 public:
  enum class Shape { any, circle };

  std::filesystem::path training;  ///< the folder with the training images
  Shape shape = Shape::any;

  void check(const Config& place, const Rig* rig) const override;
  std::vector<std::filesystem::path> files() const override { return {training}; }
};

/// For the detector `mask`: an object whose masks another program makes. Frames contain them
/// (FrameSet::masks); a recording's are read from folders.
class DIMINISH_EXPORT MaskSettings : public OccluderSettings {
 public:
  std::filesystem::path color;                        ///< the colour camera's masks
  std::map<std::string, std::filesystem::path> rgbd;  ///< by RGB-D camera; may be left out

  void check(const Config& place, const Rig* rig) const override;
};

/// For the detector `box`: whatever the RGB-D cameras see inside a box.
class DIMINISH_EXPORT BoxSettings : public OccluderSettings {
 public:
  std::string frame = "world";  ///< or an RGB-D camera's name, for its depth sensor's frame
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero(), max_m = Eigen::Vector3d::Zero();

  void check(const Config& place, const Rig* rig) const override;
  bool needs_world() const override { return frame == "world"; }
};

/// For the detector `onnx`: what a segmentation network finds. Its input is a batch of one picture
/// of 3 channels: scale * (level - mean). Its output is one picture, of one channel (from which
/// value on a pixel shows the object, `threshold` says) or of one channel for each class, of which
/// the greatest wins.
class DIMINISH_EXPORT OnnxSettings : public OccluderSettings {
 public:
  enum class Layout { nchw, nhwc };  ///< of input and output
  /// What runs the network: OpenCV's DNN module, ONNX Runtime (its library is loaded if it is
  /// installed), or the first of the two that can.
  enum class Runtime { automatic, opencv, onnxruntime };

  std::filesystem::path model;  ///< an ONNX file
  Runtime runtime = Runtime::automatic;
  int width = 0, height = 0;  ///< of the input, pixels
  double scale = 1 / 255.;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< levels of red, green, blue
  bool is_bgr = false;                             ///< the input's channels; else RGB
  Layout layout = Layout::nchw;
  std::vector<int> classes = {1};  ///< the object's; of no meaning with one channel
  double threshold = 0.5;
  /// It runs in every n-th picture only; in between, and until it has answered, the last answer is
  /// carried by the pixels' motion.
  int every = 1;
  double steady = 0;  ///< the share of the answer before in an answer, 0 to 0.9

  static constexpr int greatest_every = 100;

  void check(const Config& place, const Rig* rig) const override;
  std::vector<std::filesystem::path> files() const override { return {model}; }
};

/// For the detector `articulated`: a robot arm in the world's frame. Its links and joints are in
/// one file, the joints' positions over time in another.
class DIMINISH_EXPORT ArticulatedSettings : public OccluderSettings {
 public:
  std::filesystem::path chain;   ///< YAML: `links`, from the base up
  std::filesystem::path angles;  ///< "timestamp position ..", radians or metres
  RigidTransform world_from_base;
  double tolerance_s = 0.1;  ///< the list must say something so near to a picture's moment

  void check(const Config& place, const Rig* rig) const override;
  bool needs_world() const override { return true; }
  /// Reads the chain, whose meshes are among them.
  std::vector<std::filesystem::path> files() const override;
};

/// For the detector `difference`: whatever stands free in front of what the RGB-D cameras see.
class DIMINISH_EXPORT DifferenceSettings : public OccluderSettings {
 public:
  /// Of the distance from the colour camera to what an object hides: the share that is at least
  /// between the two, somewhere. What stands closer to its background is part of the scene.
  double clearance = 0.3;

  void check(const Config& place, const Rig* rig) const override;
};

}  // namespace diminish
