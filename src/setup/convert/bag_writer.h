#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace diminish {

/// Writes a bag of ROS 2. Messages are CDR.
class BagWriter {
 public:
  virtual ~BagWriter() = default;
  /// type: "sensor_msgs/msg/Image". Throws Error.
  virtual void write(const std::string& topic, const std::string& type, double stamp_s,
                     const std::vector<std::uint8_t>& message) = 0;
  /// Writes what makes it complete. Throws Error.
  virtual void finish() = 0;
};

/// A folder with metadata.yaml and an SQLite file. Throws Error if it is there, cannot be made, or
/// this build is without SQLite.
std::unique_ptr<BagWriter> make_sqlite_bag(const std::filesystem::path& bag);

/// An MCAP file with chunks of some megabytes, indexed; by zstd where this build has it. Throws
/// Error if the file is there or cannot be made.
std::unique_ptr<BagWriter> make_mcap(const std::filesystem::path& file);

}  // namespace diminish
