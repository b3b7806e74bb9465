#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "diminish/export.h"
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
class DIMINISH_EXPORT RecordingWriter {
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
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
