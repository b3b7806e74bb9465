#include <fmt/format.h>

#include <map>
#include <optional>

#include "core/text.h"
#include "diminish/error.h"
#include "ros/bag/bag.h"
#include "ros/bag/records.h"

namespace diminish::ros {
namespace {

constexpr std::string_view magic = "#ROSBAG V2.0\n";
enum Op : std::uint8_t { message_op = 2, chunk_op = 5, connection_op = 7 };

/// A record's or a connection's header: "name=value", each with its length before it.
class Header {
 public:
  explicit Header(std::span<const std::uint8_t> bytes) {
    Fields fields(bytes);
    while (!fields.empty()) {
      const std::string_view field = fields.text();
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) {
        throw Error(Error::input, "a record's header has a field without '='");
      }
      values_.emplace(field.substr(0, equals), field.substr(equals + 1));
    }
  }

  std::string_view text(std::string_view name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) {
      throw Error(Error::input, fmt::format("a record's header has no '{}'", name));
    }
    return found->second;
  }
  template <class Number>
  Number number(std::string_view name) const {
    const std::string_view value = text(name);
    return Fields({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()})
        .number<Number>();
  }
  std::uint8_t op() const { return number<std::uint8_t>("op"); }

 private:
  std::map<std::string_view, std::string_view> values_;
};

/// Source: wiki.ros.org/Bags/Format/2.0.
class Ros1Bag : public BagReader {
 public:
  explicit Ros1Bag(std::unique_ptr<std::istream> stream) : stream_(std::move(stream)) {
    expect_begin(*stream_, magic, "a ROS bag of version 2.0");
  }

  bool next(BagMessage& message) override {
    while (true) {
      while (!chunk_rest_.empty()) {
        if (take_record(message)) return true;
      }
      if (!read_record()) return false;
      if (take(Header(header_), data_, message)) return true;
    }
  }

 private:
  struct Connection {
    std::string topic, type;
  };

  /// From the stream. False at its end.
  bool read_record() {
    std::vector<std::uint8_t> length;
    if (!read_bytes(*stream_, 4, length)) return false;
    if (!read_bytes(*stream_, Fields(length).number<std::uint32_t>(), header_)) return false;
    if (!read_bytes(*stream_, 4, length)) return false;
    return read_bytes(*stream_, Fields(length).number<std::uint32_t>(), data_);
  }
  /// From the chunk. Whether it was a message.
  bool take_record(BagMessage& message) {
    Fields fields(chunk_rest_);
    const Header header(fields.bytes(fields.number<std::uint32_t>()));
    const auto data = fields.bytes(fields.number<std::uint32_t>());
    chunk_rest_ = fields.rest();
    // It would take the place of the one that it is read from.
    if (header.op() == chunk_op) throw Error(Error::input, "a chunk has a chunk in it");
    return take(header, data, message);
  }

  bool take(const Header& header, std::span<const std::uint8_t> data, BagMessage& message) {
    switch (header.op()) {
      case message_op: {
        const auto connection = connections_.find(header.number<std::uint32_t>("conn"));
        if (connection == connections_.end()) {
          throw Error(Error::input, "a message comes before its connection");
        }
        const auto time = header.number<std::uint64_t>("time");
        message.topic = connection->second.topic;
        message.type = connection->second.type;
        message.stamp_s =
            static_cast<double>(time & 0xffffffff) + static_cast<double>(time >> 32) * 1e-9;
        message.wire = Wire::ros1;
        message.bytes = data;
        return true;
      }
      case connection_op:
        connections_[header.number<std::uint32_t>("conn")] = {
            std::string(header.text("topic")), ros2_type(std::string(Header(data).text("type")))};
        return false;
      case chunk_op: {
        const std::string_view method = header.text("compression");
        if (method == "none") {
          chunk_.assign(data.begin(), data.end());
        } else {
          decompress(method, data, header.number<std::uint32_t>("size"), chunk_);
        }
        chunk_rest_ = chunk_;
        return false;
      }
      default:
        return false;  // an index
    }
  }

  std::unique_ptr<std::istream> stream_;
  std::vector<std::uint8_t> header_, data_, chunk_;
  std::span<const std::uint8_t> chunk_rest_;
  std::map<std::uint32_t, Connection> connections_;
};

}  // namespace

std::unique_ptr<BagReader> open_ros1_bag(std::unique_ptr<std::istream> stream) {
  return std::make_unique<Ros1Bag>(std::move(stream));
}

}  // namespace diminish::ros
