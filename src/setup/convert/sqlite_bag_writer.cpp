#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>

#include "diminish/error.h"
#include "setup/convert/bag_writer.h"
#include "sink/partial_file.h"

namespace diminish {
namespace {

/// As rosbag2 of ROS 2 Humble (metadata version 5) makes them.
constexpr const char* tables =
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
    "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
    "timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
    "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
    "BEGIN";

class SqliteBagWriter : public BagWriter {
 public:
  /// Throws Error if the folder is there, or cannot be made.
  explicit SqliteBagWriter(const std::filesystem::path& bag);
  ~SqliteBagWriter() override;
  SqliteBagWriter(const SqliteBagWriter&) = delete;
  SqliteBagWriter& operator=(const SqliteBagWriter&) = delete;

  void write(const std::string& topic, const std::string& type, double stamp_s,
             const std::vector<std::uint8_t>& message) override;
  /// Writes metadata.yaml. A bag without it was not finished.
  void finish() override;

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

SqliteBagWriter::SqliteBagWriter(const std::filesystem::path& bag) : folder_(bag) {
  std::error_code error;
  if (std::filesystem::exists(bag, error)) {
    throw Error(Error::io, bag.string() + ": expected a folder that is not there yet");
  }
  std::filesystem::create_directories(bag, error);
  file_ = std::filesystem::absolute(bag).lexically_normal().filename().string() + "_0.db3";
  if (sqlite3_open((folder_ / file_).c_str(), &database_) != SQLITE_OK) fail();
  run(tables);
  add_topic_ = prepare("INSERT INTO topics VALUES (?1, ?2, ?3, 'cdr', '')");
  add_message_ = prepare("INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)");
}

SqliteBagWriter::~SqliteBagWriter() {
  sqlite3_finalize(add_topic_);
  sqlite3_finalize(add_message_);
  sqlite3_close(database_);
}

void SqliteBagWriter::fail() {
  throw Error(Error::io, (folder_ / file_).string() + ": " + sqlite3_errmsg(database_));
}

void SqliteBagWriter::run(const char* statement) {
  if (sqlite3_exec(database_, statement, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

sqlite3_stmt* SqliteBagWriter::prepare(const char* statement) {
  sqlite3_stmt* made = nullptr;
  if (sqlite3_prepare_v2(database_, statement, -1, &made, nullptr) != SQLITE_OK) fail();
  return made;
}

void SqliteBagWriter::step(sqlite3_stmt* statement) {
  if (sqlite3_step(statement) != SQLITE_DONE) fail();
  sqlite3_reset(statement);
}

void SqliteBagWriter::write(const std::string& name, const std::string& type, double stamp_s,
                            const std::vector<std::uint8_t>& message) {
  Topic& topic = topics_[name];
  if (topic.messages == 0) {
    topic.id = static_cast<std::int64_t>(topics_.size());
    topic.type = type;
    sqlite3_bind_int64(add_topic_, 1, topic.id);
    sqlite3_bind_text(add_topic_, 2, name.c_str(), -1, SQLITE_TRANSIENT);
    sqlite3_bind_text(add_topic_, 3, type.c_str(), -1, SQLITE_TRANSIENT);
    step(add_topic_);
  }
  ++topic.messages;
  const auto stamp_ns = static_cast<std::int64_t>(std::llround(stamp_s * 1e9));
  first_ns_ = last_ns_ == 0 ? stamp_ns : std::min(first_ns_, stamp_ns);
  last_ns_ = std::max(last_ns_, stamp_ns);
  sqlite3_bind_int64(add_message_, 1, topic.id);
  sqlite3_bind_int64(add_message_, 2, stamp_ns);
  sqlite3_bind_blob64(add_message_, 3, message.data(), message.size(), SQLITE_STATIC);
  step(add_message_);
}

void SqliteBagWriter::finish() {
  run("COMMIT");
  std::size_t count = 0;
  std::string topics;
  for (const auto& [name, topic] : topics_) {
    count += topic.messages;
    topics += fmt::format(
        "    - topic_metadata:\n        name: {}\n        type: {}\n"
        "        serialization_format: cdr\n        offered_qos_profiles: \"\"\n"
        "      message_count: {}\n",
        name, topic.type, topic.messages);
  }
  const std::int64_t duration_ns = last_ns_ - first_ns_;
  write_file(folder_ / "metadata.yaml",
             fmt::format("rosbag2_bagfile_information:\n"
                         "  version: 5\n"
                         "  storage_identifier: sqlite3\n"
                         "  duration:\n    nanoseconds: {0}\n"
                         "  starting_time:\n    nanoseconds_since_epoch: {1}\n"
                         "  message_count: {2}\n"
                         "  topics_with_message_count:\n{3}"
                         "  compression_format: \"\"\n  compression_mode: \"\"\n"
                         "  relative_file_paths:\n    - {4}\n"
                         "  files:\n    - path: {4}\n"
                         "      starting_time:\n        nanoseconds_since_epoch: {1}\n"
                         "      duration:\n        nanoseconds: {0}\n"
                         "      message_count: {2}\n",
                         duration_ns, first_ns_, count, topics, file_));
}

}  // namespace

std::unique_ptr<BagWriter> make_sqlite_bag(const std::filesystem::path& bag) {
  return std::make_unique<SqliteBagWriter>(bag);
}

}  // namespace diminish
