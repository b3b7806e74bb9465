#include <fmt/format.h>
#include <sqlite3.h>

#include "diminish/error.h"
#include "ros/bag/bag.h"

namespace diminish::ros {
namespace {

/// Source: rosbag2_storage_sqlite3's tables `topics` and `messages`.
constexpr const char* query =
    "SELECT topics.name, topics.type, messages.timestamp, messages.data "
    "FROM messages JOIN topics ON messages.topic_id = topics.id "
    "WHERE topics.serialization_format = 'cdr' ORDER BY messages.timestamp";

class SqliteBag : public BagReader {
 public:
  explicit SqliteBag(const std::filesystem::path& file) {
    if (sqlite3_open_v2(file.c_str(), &database_, SQLITE_OPEN_READONLY, nullptr) != SQLITE_OK ||
        sqlite3_prepare_v2(database_, query, -1, &rows_, nullptr) != SQLITE_OK) {
      const std::string reason = sqlite3_errmsg(database_);
      close();
      throw Error(Error::input, "expected a ROS 2 bag: " + reason);
    }
  }
  ~SqliteBag() override { close(); }
  SqliteBag(const SqliteBag&) = delete;
  SqliteBag& operator=(const SqliteBag&) = delete;

  bool next(BagMessage& message) override {
    const int result = sqlite3_step(rows_);
    if (result == SQLITE_DONE) return false;
    if (result != SQLITE_ROW) throw Error(Error::input, sqlite3_errmsg(database_));
    message.topic = text(0);
    message.type = text(1);
    message.stamp_s = static_cast<double>(sqlite3_column_int64(rows_, 2)) * 1e-9;
    message.wire = Wire::cdr;
    const auto* const data = static_cast<const std::uint8_t*>(sqlite3_column_blob(rows_, 3));
    message.bytes = {data, static_cast<std::size_t>(sqlite3_column_bytes(rows_, 3))};
    return true;
  }

 private:
  std::string text(int column) const {
    const auto* const raw = reinterpret_cast<const char*>(sqlite3_column_text(rows_, column));
    return raw ? raw : "";
  }
  void close() {
    sqlite3_finalize(rows_);
    sqlite3_close(database_);
  }

  sqlite3* database_ = nullptr;
  sqlite3_stmt* rows_ = nullptr;
};

}  // namespace

std::unique_ptr<BagReader> open_sqlite_bag(const std::filesystem::path& file) {
  return std::make_unique<SqliteBag>(file);
}

}  // namespace diminish::ros
