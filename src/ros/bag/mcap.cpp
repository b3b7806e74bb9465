#include <map>

#include "core/text.h"
#include "diminish/error.h"
#include "ros/bag/bag.h"
#include "ros/bag/mcap_records.h"
#include "ros/bag/records.h"

namespace diminish::ros {
namespace {

constexpr std::size_t record_head_bytes = 9;

class Mcap : public BagReader {
  using enum mcap::Op;

 public:
  explicit Mcap(std::unique_ptr<std::istream> stream) : stream_(std::move(stream)) {
    expect_begin(*stream_, mcap::magic, "an MCAP file of version 0");
  }

  bool next(BagMessage& message) override {
    while (true) {
      while (!chunk_rest_.empty()) {
        Fields fields(chunk_rest_);
        const auto op = fields.number<std::uint8_t>();
        const auto content = fields.bytes(fields.number<std::uint64_t>());
        chunk_rest_ = fields.rest();
        if (op != chunk_op && take(op, content, message)) return true;
      }
      if (is_over_ || !read_bytes(*stream_, record_head_bytes, head_)) return false;
      Fields head(head_);
      const auto op = head.number<std::uint8_t>();
      is_over_ = op == data_end_op || op == footer_op;
      if (is_over_ || !read_bytes(*stream_, head.number<std::uint64_t>(), record_)) return false;
      if (take(op, record_, message)) return true;
    }
  }

 private:
  struct Channel {
    std::uint16_t schema = 0;
    std::string topic;
    Wire wire = Wire::cdr;
    bool is_readable = false;
  };

  /// Whether it was a message.
  bool take(std::uint8_t op, std::span<const std::uint8_t> content, BagMessage& message) {
    Fields fields(content);
    switch (op) {
      case schema_op: {
        const auto id = fields.number<std::uint16_t>();
        schemas_[id] = ros2_type(std::string(fields.text()));
        return false;
      }
      case channel_op: {
        const auto id = fields.number<std::uint16_t>();
        Channel channel;
        channel.schema = fields.number<std::uint16_t>();
        channel.topic = fields.text();
        const std::string_view encoding = fields.text();
        channel.wire = encoding == "ros1" ? Wire::ros1 : Wire::cdr;
        channel.is_readable = encoding == "cdr" || encoding == "ros1";
        channels_[id] = std::move(channel);
        return false;
      }
      case message_op: {
        const auto channel = channels_.find(fields.number<std::uint16_t>());
        if (channel == channels_.end()) {
          throw Error(Error::input, "a message comes before its channel");
        }
        if (!channel->second.is_readable) return false;
        fields.number<std::uint32_t>();  // its sequence number
        message.topic = channel->second.topic;
        const auto schema = schemas_.find(channel->second.schema);
        message.type = schema == schemas_.end() ? "" : schema->second;
        message.stamp_s = static_cast<double>(fields.number<std::uint64_t>()) * 1e-9;
        fields.number<std::uint64_t>();  // when it was sent
        message.wire = channel->second.wire;
        message.bytes = fields.rest();
        return true;
      }
      case chunk_op: {
        fields.number<std::uint64_t>();  // the first time in it
        fields.number<std::uint64_t>();  // and the last
        const auto size = fields.number<std::uint64_t>();
        fields.number<std::uint32_t>();  // its checksum
        const std::string_view method = fields.text();
        const auto packed = fields.bytes(fields.number<std::uint64_t>());
        if (method.empty()) {
          chunk_.assign(packed.begin(), packed.end());
        } else {
          decompress(method, packed, size, chunk_);
        }
        chunk_rest_ = chunk_;
        return false;
      }
      default:
        return false;  // an index, an attachment
    }
  }

  std::unique_ptr<std::istream> stream_;
  std::vector<std::uint8_t> head_, record_, chunk_;
  std::span<const std::uint8_t> chunk_rest_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  bool is_over_ = false;
};

}  // namespace

std::unique_ptr<BagReader> open_mcap(std::unique_ptr<std::istream> stream) {
  return std::make_unique<Mcap>(std::move(stream));
}

}  // namespace diminish::ros
