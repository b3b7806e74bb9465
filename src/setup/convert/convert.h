#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "diminish/intrinsics.h"

namespace diminish {

/// Which topics of a bag become which camera. Empty: chosen by their names and contents.
struct BagChoice {
  struct Camera {
    std::string name, color, depth;
  };
  std::string color;  ///< of the user's view; empty: the first camera's
  std::vector<Camera> rgbd;
};

/// What was converted.
struct Conversion {
  struct Stream {
    std::string name, from;  ///< "rgbd0_depth", and the topic or list it comes from
    std::size_t images = 0;
  };
  std::vector<Stream> streams;
  std::size_t left_out = 0;           ///< images: broken, or not later than the one before
  std::vector<std::string> problems;  ///< the first few reasons
};

/// Makes a recording (docs/recording-format.md) of a ROS bag. Colour that is JPEG already stays as
/// it is. Reads the bag twice. Throws Error that names the file or topic.
Conversion convert_bag(const std::filesystem::path& bag, const std::filesystem::path& recording,
                       const BagChoice& choice);

/// Whether a folder is one of the TUM RGB-D benchmark: rgb.txt and depth.txt.
bool is_tum_folder(const std::filesystem::path& folder);

/// Makes a recording of a TUM RGB-D folder, whose depth is registered to its colour, in 1/5000 m.
/// lens: of both; such folders do not tell it.
Conversion convert_tum(const std::filesystem::path& folder, const std::filesystem::path& recording,
                       const Intrinsics& lens);

/// The lens that the benchmark gives for its images where none is calibrated: 525 pixels.
Intrinsics tum_lens();

/// Whether a file is a Matroska one, by its first bytes.
bool is_matroska(const std::filesystem::path& file);

/// Makes a recording of an Azure Kinect's .mkv (k4arecorder): its JPEGs as they are, depth in
/// millimetres, and the lenses that the device knows. What is infrared or of the motion sensor is
/// left out. Throws Error that names the file.
Conversion convert_kinect(const std::filesystem::path& file,
                          const std::filesystem::path& recording);

/// Makes a TUM RGB-D folder of one of a recording's RGB-D cameras. Images that are registered, and
/// of a lens without distortion, stay as they are; otherwise both are drawn as the depth sensor
/// would see them with such a lens. camera.txt has that lens; groundtruth.txt the camera's poses,
/// where rig.yaml names a list of them. Throws Error.
Conversion convert_to_tum(const std::filesystem::path& recording,
                          const std::filesystem::path& folder, const std::string& camera);

/// Makes a ROS 2 bag of a recording: FILE.mcap, or a folder (SQLite, with metadata.yaml). Each
/// camera's images with their camera_info below /NAME, and the cameras' transforms on /tf_static.
/// Throws Error.
Conversion convert_to_bag(const std::filesystem::path& recording, const std::filesystem::path& bag);

}  // namespace diminish
