#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace diminish {

/// Writes a ROS 2 bag: a folder with metadata.yaml and an SQLite file. Messages are CDR.
class SqliteBagWriter {
 public:
  /// Throws Error if the folder is there, or cannot be made.
  explicit SqliteBagWriter(const std::filesystem::path& bag);
  ~SqliteBagWriter();
  SqliteBagWriter(const SqliteBagWriter&) = delete;
  SqliteBagWriter& operator=(const SqliteBagWriter&) = delete;

  /// type: "sensor_msgs/msg/Image". Throws Error.
  void write(const std::string& topic, const std::string& type, double stamp_s,
             const std::vector<std::uint8_t>& message);
  /// Writes metadata.yaml. A bag without it was not finished. Throws Error.
  void finish();

 private:
  struct Topic {
    std::int64_t id = 0;
    std::string type;
    std::size_t messages = 0;
  };
  void run(const char* statement);
  sqlite3_stmt* prepare(const char* statement);
  void step(sqlite3_stmt* statement);
  [[noreturn]] void fail();

  std::filesystem::path folder_;
  std::string file_;
  sqlite3* database_ = nullptr;
  sqlite3_stmt *add_topic_ = nullptr, *add_message_ = nullptr;
  std::map<std::string, Topic> topics_;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
};

}  // namespace diminish
