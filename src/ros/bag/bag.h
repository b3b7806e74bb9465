#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ros/message_reader.h"

namespace diminish::ros {

/// A message of a bag. The bytes are valid until the next one is read.
struct BagMessage {
  std::string topic;
  std::string type;    ///< as ROS 2 names it: "sensor_msgs/msg/Image"
  double stamp_s = 0;  ///< when it was recorded, UTC
  Wire wire = Wire::cdr;
  std::span<const std::uint8_t> bytes;
};

/// Reads a bag from its beginning to its end, in the order of the file.
class BagReader {
 public:
  virtual ~BagReader() = default;
  /// False at the end. A file that was cut off ends there. Throws Error (input) that says what was
  /// expected where it is broken.
  virtual bool next(BagMessage& message) = 0;
};

/// A ROS 1 bag (version 2.0; chunks as they are, bz2, lz4), a ROS 2 bag (a folder, its SQLite or
/// its MCAP file; chunks as they are, lz4, zstd). A folder with several files is read file after
/// file. Throws Error that names the file.
std::unique_ptr<BagReader> open_bag(const std::filesystem::path& bag);

/// Whether a file or folder is one, by its first bytes.
bool is_bag(const std::filesystem::path& path);

// Of streams, for the tests of hostile ones.
std::unique_ptr<BagReader> open_ros1_bag(std::unique_ptr<std::istream> stream);
std::unique_ptr<BagReader> open_mcap(std::unique_ptr<std::istream> stream);
/// Throws Error where this build is without SQLite.
std::unique_ptr<BagReader> open_sqlite_bag(const std::filesystem::path& file);

/// "sensor_msgs/msg/Image" of "sensor_msgs/Image".
std::string ros2_type(const std::string& ros1_type);

}  // namespace diminish::ros
