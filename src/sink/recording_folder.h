#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/poses.h"
#include "diminish/rig.h"
#include "diminish/scene.h"

namespace diminish {

/// Throws Error if the folder is there and not empty, or cannot be made.
void make_recording_folder(const std::filesystem::path& folder);

/// Writes a recording (docs/recording-format.md), without its rig.yaml. Depth is lossless. The
/// folder holds complete images and lists at any moment.
class RecordingFolder {
 public:
  enum class Pictures { jpeg, png };

  /// Makes the folder and copies scene.yaml and the files that it names into it. Throws Error if
  /// the folder is not empty or a file cannot be copied.
  RecordingFolder(std::filesystem::path folder, const Rig& rig,
                  const std::filesystem::path& scene_file, const Scene& scene, Pictures pictures);

  const std::filesystem::path& path() const { return folder_; }
  /// Where a file or folder belongs that scene.yaml names. Throws Error if it is not below
  /// scene.yaml's folder.
  std::filesystem::path place_of(const std::filesystem::path& named) const;
  /// Adds a frame; its images are called `name`. An image with the timestamp of the one before is
  /// that one, and one that is the colour camera's picture is not written again. If the clock was
  /// set back, time goes on from the frame before. Returns whether it is a new frame: with the
  /// timestamp of the last one it is not, and nothing is written. Throws Error.
  bool write(const FrameSet& frame, const std::string& name);

  /// Begins a list of poses for each camera. Returns what rig.yaml has to say as `pose`. Throws
  /// Error.
  std::string keep_poses(const Rig& rig);
  /// Adds those of the frame that was written last. Throws Error.
  void add_poses(const FrameSet& frame, const Poses& poses);

 private:
  /// A sensor's folder and list.
  struct Stream {
    std::string folder;  ///< relative: "rgbd0/depth"
    std::filesystem::path list_file;
    std::ofstream list;
    std::uintmax_t list_bytes = 0;  ///< of whole lines
    double last_stamp_s = -1;
  };
  Stream make_stream(const std::string& list, const std::string& folder) const;
  const char* extension(bool is_color) const {
    return is_color && pictures_ == Pictures::jpeg ? ".jpg" : ".png";
  }
  std::string file_of(const Stream& stream, const std::string& name, bool is_color) const;
  template <class Pixel>
  void write_image(Stream& stream, const InputImage<Pixel>& image, double stamp_s,
                   const std::string& name);
  /// The timestamps in a list must increase.
  void follow_clock(double stamp_s);
  /// A line is written whole or not at all. Throws Error.
  static void append(Stream& stream, const std::string& line);
  void add_pose(Stream& list, double stamp_s, const RigidTransform& camera_from_world);
  static void add(Stream& stream, double stamp_s, const std::string& file);

  std::filesystem::path folder_, scene_file_;
  Pictures pictures_;
  Stream color_;
  std::vector<Stream> rgbd_color_;
  std::vector<std::optional<Stream>> rgbd_depth_;  ///< of cameras that measure depth
  std::vector<Stream> pose_lists_;                 ///< of the colour camera, then the others
  std::vector<RigidTransform> posed_from_depth_;   ///< of these
  double clock_shift_s_ = 0;                       ///< added to all timestamps
  std::vector<std::uint8_t> bytes_;
};

/// Copies a file or folder; makes the folders that are missing. Throws Error.
void copy_to(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace diminish
