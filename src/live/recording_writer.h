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
  std::size_t dropped = 0;  ///< the disk or the encoder was too slow for them
  std::string problem;      ///< why it ended; empty if it did not, or as asked
};

/// Writes what a live session works on as a recording (docs/recording-format.md): depth without
/// loss, colour as JPEG. A thread of its own does the work; a frame for which it has no time is
/// dropped and counted. What is in the folder is a whole recording at any moment.
class RecordingWriter {
 public:
  /// Makes the folder and copies the set-up into it: rig.yaml, scene.yaml, and what the latter
  /// names. Throws Error if the folder holds something, or the set-up cannot be copied.
  RecordingWriter(std::filesystem::path folder, const std::filesystem::path& rig_file,
                  const Rig& rig, const std::filesystem::path& scene_file, const Scene& scene);
  /// Writes what is waiting.
  ~RecordingWriter();

  /// Takes a frame if there is room for it; returns at once.
  void offer(std::shared_ptr<const LiveFrame> frame);

  RecordingStatus status() const;
  /// Writes what is waiting, and ends.
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
