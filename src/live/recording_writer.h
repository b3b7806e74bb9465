#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "diminish/live.h"

namespace diminish {

struct RecordingStatus {
  bool active = false;
  std::string folder;
  std::size_t frames = 0;   ///< written
  std::size_t dropped = 0;  ///< because the disk or the encoder was too slow
  std::string problem;      ///< why it stopped early; empty if it did not
};

/// Writes a live session's input as a recording (docs/recording-format.md): lossless depth, colour
/// as JPEG. Works in its own thread. Frames for which it has no time are dropped and counted. The
/// folder holds a complete recording at any moment.
class RecordingWriter {
 public:
  /// Makes the folder and copies rig.yaml, scene.yaml and the files that scene.yaml names into it.
  /// Throws Error if the folder is not empty or a file cannot be copied.
  RecordingWriter(std::filesystem::path folder, const std::filesystem::path& rig_file,
                  const Rig& rig, const std::filesystem::path& scene_file, const Scene& scene);
  /// Writes the waiting frames.
  ~RecordingWriter();

  /// Queues a frame if there is room; returns at once.
  void offer(std::shared_ptr<const LiveFrame> frame);

  RecordingStatus status() const;
  /// Writes the waiting frames and ends.
  void finish();

 private:
  /// A sensor's folder and list.
  struct Stream {
    std::string folder;  ///< relative: "rgbd0/depth"
    std::ofstream list;
    double last_stamp_s = -1;
    std::size_t images = 0;
  };

  Stream make_stream(const std::string& list, const std::string& folder) const;
  void work();
  void write(const LiveFrame& frame);
  template <class Pixel>
  void write_image(Stream& stream, const Image<Pixel>& image, double stamp_s);

  static constexpr std::size_t most_waiting = 8;

  std::filesystem::path folder_;
  Stream color_;
  std::vector<Stream> rgbd_color_, rgbd_depth_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<const LiveFrame>> waiting_;
  RecordingStatus status_;
  bool ending_ = false;
  std::vector<std::uint8_t> bytes_;
  std::thread thread_;
};

}  // namespace diminish
