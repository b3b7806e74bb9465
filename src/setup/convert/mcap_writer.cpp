#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <system_error>

#include "diminish/error.h"
#include "ros/bag/mcap_records.h"
#include "setup/convert/bag_writer.h"
#include "setup/convert/message_definitions.h"
#include "sink/partial_file.h"

#ifdef DIMINISH_HAS_ZSTD
#include <zstd.h>
#endif

namespace diminish {
namespace {

// Source: mcap.dev/spec, version 0; mcap.dev/spec/registry for the profile and encodings of ROS 2.

using enum ros::mcap::Op;
using ros::mcap::magic;
using ros::mcap::Op;

constexpr std::size_t chunk_bytes = 4u << 20;

/// The content of a record, field after field, the least significant byte first.
class Record {
 public:
  template <class Number>
  Record& number(Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> 8 * i);
    }
    return *this;
  }
  Record& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  Record& text(std::string_view value) {
    return number(static_cast<std::uint32_t>(value.size())).raw(value);
  }
  const std::string& bytes() const { return bytes_; }
  std::string framed(Op op) const {
    return Record().number(op).number(std::uint64_t{bytes_.size()}).raw(bytes_).bytes();
  }

 private:
  std::string bytes_;
};

/// Empty where this build is without zstd.
std::string compressed([[maybe_unused]] const std::string& bytes) {
#ifdef DIMINISH_HAS_ZSTD
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 1);
  if (ZSTD_isError(size) == 0) return packed.substr(0, size);
#endif
  return "";
}

class McapWriter : public BagWriter {
 public:
  explicit McapWriter(const std::filesystem::path& file) : name_(file.string()), target_(file) {
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) {
      throw Error(Error::io, name_ + ": expected a file that is not there yet");
    }
    file_.open(target_.path(), std::ios::binary);
    put(magic);
    put(Record().text("ros2").text("diminish " DIMINISH_VERSION).framed(header_op));
  }

  void write(const std::string& topic, const std::string& type, double stamp_s,
             const std::vector<std::uint8_t>& message) override {
    const std::uint16_t channel = channel_of(topic, type);
    const auto stamp_ns = static_cast<std::uint64_t>(std::llround(stamp_s * 1e9));
    index_[channel].emplace_back(stamp_ns, chunk_.size());
    Record record;
    record.number(channel).number(sequence_++).number(stamp_ns).number(stamp_ns);
    record.raw({reinterpret_cast<const char*>(message.data()), message.size()});
    chunk_ += record.framed(message_op);
    chunk_span_.add(stamp_ns);
    span_.add(stamp_ns);
    ++counts_[channel];
    if (chunk_.size() >= chunk_bytes) end_chunk();
  }

  void finish() override {
    end_chunk();
    put(Record().number(std::uint32_t{0}).framed(data_end_op));
    const std::uint64_t summary = at_;
    put(schemas_);
    put(channels_);
    Record statistics;
    statistics.number(std::uint64_t{sequence_})
        .number(static_cast<std::uint16_t>(schema_ids_.size()))
        .number(static_cast<std::uint32_t>(channel_ids_.size()))
        .number(std::uint32_t{0})  // attachments
        .number(std::uint32_t{0})  // metadata
        .number(chunks_)
        .number(span_.first_ns)
        .number(span_.last_ns);
    Record counts;
    for (const auto& [channel, count] : counts_) counts.number(channel).number(count);
    statistics.text(counts.bytes());
    put(statistics.framed(statistics_op));
    put(chunk_indices_);
    put(Record()
            .number(summary)
            .number(std::uint64_t{0})  // no offsets into the summary
            .number(std::uint32_t{0})  // no checksum
            .framed(footer_op));
    put(magic);
    file_.close();
    if (!file_) fail();
    target_.commit();
  }

 private:
  struct Span {
    std::uint64_t first_ns = 0, last_ns = 0;
    void add(std::uint64_t stamp_ns) {
      first_ns = last_ns == 0 ? stamp_ns : std::min(first_ns, stamp_ns);
      last_ns = std::max(last_ns, stamp_ns);
    }
  };

  [[noreturn]] void fail() const { throw Error(Error::io, name_ + ": cannot be written"); }

  void put(std::string_view bytes) {
    file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!file_) fail();
    at_ += bytes.size();
  }

  std::uint16_t channel_of(const std::string& topic, const std::string& type) {
    const auto [schema, is_new_type] =
        schema_ids_.emplace(type, static_cast<std::uint16_t>(schema_ids_.size() + 1));
    if (is_new_type) {
      const std::string record = Record()
                                     .number(schema->second)
                                     .text(type)
                                     .text("ros2msg")
                                     .text(message_definition(type))
                                     .framed(schema_op);
      schemas_ += record;
      chunk_ += record;
    }
    const auto [channel, is_new] =
        channel_ids_.emplace(topic, static_cast<std::uint16_t>(channel_ids_.size() + 1));
    if (is_new) {
      const std::string record = Record()
                                     .number(channel->second)
                                     .number(schema->second)
                                     .text(topic)
                                     .text("cdr")
                                     .text("")  // no metadata
                                     .framed(channel_op);
      channels_ += record;
      chunk_ += record;
    }
    return channel->second;
  }

  void end_chunk() {
    if (chunk_.empty()) return;
    const std::string packed = compressed(chunk_);
    const std::string_view method = packed.empty() ? "" : "zstd";
    const std::string_view stored = packed.empty() ? std::string_view(chunk_) : packed;
    const std::uint64_t start = at_;
    put(Record()
            .number(chunk_span_.first_ns)
            .number(chunk_span_.last_ns)
            .number(std::uint64_t{chunk_.size()})
            .number(std::uint32_t{0})  // no checksum
            .text(method)
            .number(std::uint64_t{stored.size()})
            .raw(stored)
            .framed(chunk_op));
    const std::uint64_t index_start = at_;
    Record offsets;
    for (const auto& [channel, entries] : index_) {
      offsets.number(channel).number(at_);
      Record places;
      for (const auto& [stamp_ns, place] : entries) places.number(stamp_ns).number(place);
      put(Record().number(channel).text(places.bytes()).framed(message_index_op));
    }
    chunk_indices_ += Record()
                          .number(chunk_span_.first_ns)
                          .number(chunk_span_.last_ns)
                          .number(start)
                          .number(index_start - start)
                          .text(offsets.bytes())
                          .number(at_ - index_start)
                          .text(method)
                          .number(std::uint64_t{stored.size()})
                          .number(std::uint64_t{chunk_.size()})
                          .framed(chunk_index_op);
    ++chunks_;
    chunk_.clear();
    index_.clear();
    chunk_span_ = {};
  }

  std::string name_;
  PartialFile target_;
  std::ofstream file_;
  std::uint64_t at_ = 0;  ///< bytes written
  std::map<std::string, std::uint16_t> schema_ids_, channel_ids_;
  std::string schemas_, channels_, chunk_indices_;  ///< for the summary
  std::string chunk_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  Span chunk_span_, span_;
  std::uint32_t sequence_ = 0, chunks_ = 0;
};

}  // namespace

std::unique_ptr<BagWriter> make_mcap(const std::filesystem::path& file) {
  return std::make_unique<McapWriter>(file);
}

}  // namespace diminish
