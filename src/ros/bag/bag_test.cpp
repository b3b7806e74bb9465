#include "ros/bag/bag.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "expect_error.h"
#include "ros/bag/records.h"
#include "temporary_folder.h"

#ifdef DIMINISH_HAS_BZIP2
#include <bzlib.h>
#endif
#ifdef DIMINISH_HAS_LZ4
#include <lz4frame.h>
#endif
#ifdef DIMINISH_HAS_ZSTD
#include <zstd.h>
#endif

namespace diminish::ros {
namespace {

using ::testing::HasSubstr;

/// Bytes, the least significant first.
template <class Number>
std::string raw(Number value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> 8 * i);
  }
  return bytes;
}
std::string with_length(const std::string& text) {
  return raw(static_cast<std::uint32_t>(text.size())) + text;
}

std::string pack([[maybe_unused]] const std::string& method, const std::string& bytes) {
  std::string packed(bytes.size() + 1000, '\0');
  std::size_t size = 0;
#ifdef DIMINISH_HAS_BZIP2
  if (method == "bz2") {
    auto length = static_cast<unsigned>(packed.size());
    BZ2_bzBuffToBuffCompress(packed.data(), &length, const_cast<char*>(bytes.data()),
                             static_cast<unsigned>(bytes.size()), 9, 0, 0);
    size = length;
  }
#endif
#ifdef DIMINISH_HAS_LZ4
  if (method == "lz4") {
    size = LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr);
  }
#endif
#ifdef DIMINISH_HAS_ZSTD
  if (method == "zstd") {
    size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3);
  }
#endif
  return size == 0 ? bytes : packed.substr(0, size);
}

/// The methods that this build and this test have.
std::vector<std::string> methods(const std::vector<std::string>& of_format) {
  std::vector<std::string> known = {"none", ""};
#ifdef DIMINISH_HAS_BZIP2
  known.emplace_back("bz2");
#endif
#ifdef DIMINISH_HAS_LZ4
  known.emplace_back("lz4");
#endif
#ifdef DIMINISH_HAS_ZSTD
  known.emplace_back("zstd");
#endif
  std::vector<std::string> both;
  for (const std::string& method : of_format) {
    if (std::find(known.begin(), known.end(), method) != known.end()) both.push_back(method);
  }
  return both;
}

/// A ROS 1 bag, written after wiki.ros.org/Bags/Format/2.0.
std::string ros1_record(std::uint8_t op, const std::string& fields, const std::string& data) {
  return with_length(fields + with_length("op=" + raw(op))) + with_length(data);
}
std::string ros1_bag(const std::string& method) {
  const std::string connection = ros1_record(
      7, with_length("conn=" + raw(std::uint32_t{3})) + with_length("topic=/camera/image"),
      with_length("topic=/camera/image") + with_length("type=sensor_msgs/Image"));
  const auto message = [](std::uint32_t seconds, const std::string& data) {
    return ros1_record(2,
                       with_length("conn=" + raw(std::uint32_t{3})) +
                           with_length("time=" + raw(seconds) + raw(std::uint32_t{500'000'000})),
                       data);
  };
  const std::string chunk = connection + message(7, "first") + message(8, std::string(5000, 'x'));
  const std::string packed = method == "none" ? chunk : pack(method, chunk);
  return "#ROSBAG V2.0\n" +
         ros1_record(3, with_length("chunk_count=" + raw(std::uint32_t{1})), "") +
         ros1_record(5,
                     with_length("compression=" + method) +
                         with_length("size=" + raw(static_cast<std::uint32_t>(chunk.size()))),
                     packed) +
         ros1_record(4, with_length("ver=" + raw(std::uint32_t{1})), "index") +
         message(9, "outside of a chunk");
}

/// An MCAP file, written after mcap.dev/spec.
std::string mcap_record(std::uint8_t op, const std::string& content) {
  return raw(op) + raw(static_cast<std::uint64_t>(content.size())) + content;
}
std::string mcap(const std::string& method) {
  const std::string schema =
      mcap_record(3, raw(std::uint16_t{1}) + with_length("sensor_msgs/msg/Image") +
                         with_length("ros2msg") + with_length("..."));
  const auto channel = [](std::uint16_t id, const std::string& encoding) {
    return mcap_record(4, raw(id) + raw(std::uint16_t{1}) + with_length("/camera/image") +
                              with_length(encoding) + with_length(""));
  };
  const auto message = [](std::uint16_t on, std::uint64_t stamp_ns, const std::string& data) {
    return mcap_record(5, raw(on) + raw(std::uint32_t{0}) + raw(stamp_ns) + raw(stamp_ns) + data);
  };
  const std::string records = schema + channel(2, "cdr") + channel(9, "json") +
                              message(2, 7'500'000'000, "first") + message(9, 1, "{}") +
                              message(2, 8'500'000'000, std::string(5000, 'x'));
  const std::string packed = method.empty() ? records : pack(method, records);
  const std::string chunk = mcap_record(
      6, raw(std::uint64_t{0}) + raw(std::uint64_t{0}) +
             raw(static_cast<std::uint64_t>(records.size())) + raw(std::uint32_t{0}) +
             with_length(method) + raw(static_cast<std::uint64_t>(packed.size())) + packed);
  const std::string magic = "\x89MCAP0\r\n";
  return magic + mcap_record(1, with_length("ros2") + with_length("test")) + chunk +
         message(2, 9'500'000'000, "outside of a chunk") + mcap_record(15, raw(std::uint32_t{0})) +
         mcap_record(2, std::string(20, '\0')) + magic;
}

using Open = std::unique_ptr<BagReader> (*)(std::unique_ptr<std::istream>);

struct Read {
  std::string topic, type, data;
  double stamp_s;
  Wire wire;
};
std::vector<Read> read_all(Open open, const std::string& bytes) {
  std::vector<Read> all;
  const auto reader = open(std::make_unique<std::istringstream>(bytes));
  for (BagMessage message; reader->next(message);) {
    all.push_back({message.topic,
                   message.type,
                   {message.bytes.begin(), message.bytes.end()},
                   message.stamp_s,
                   message.wire});
  }
  return all;
}

void expect_messages(const std::vector<Read>& read, Wire wire) {
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[0].data, "first");
  EXPECT_EQ(read[1].data, std::string(5000, 'x'));
  EXPECT_EQ(read[2].data, "outside of a chunk");
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read[i].topic, "/camera/image");
    EXPECT_EQ(read[i].type, "sensor_msgs/msg/Image");
    EXPECT_DOUBLE_EQ(read[i].stamp_s, 7.5 + static_cast<double>(i));
    EXPECT_EQ(read[i].wire, wire);
  }
}

TEST(Bag, Ros1BagsAreRead) {
  for (const std::string& method : methods({"none", "bz2", "lz4"})) {
    SCOPED_TRACE(method);
    expect_messages(read_all(open_ros1_bag, ros1_bag(method)), Wire::ros1);
  }
}

TEST(Bag, McapFilesAreRead) {
  for (const std::string& method : methods({"", "lz4", "zstd"})) {
    SCOPED_TRACE(method);
    expect_messages(read_all(open_mcap, mcap(method)), Wire::cdr);
  }
}

TEST(Bag, WhatWasCutOffIsReadUpToThere) {
  const std::string bag = ros1_bag("none");
  EXPECT_EQ(read_all(open_ros1_bag, bag.substr(0, bag.size() - 5)).size(), 2U);
  const std::string file = mcap("");
  EXPECT_EQ(read_all(open_mcap, file.substr(0, file.size() - 80)).size(), 2U);
}

TEST(Bag, WhatIsBrokenIsSaid) {
  const auto error = [](Open open, const std::string& bytes) {
    return error_of([&] { read_all(open, bytes); });
  };
  EXPECT_THAT(error(open_ros1_bag, "#ROSBAG V1.2\n..."), HasSubstr("version 2.0"));
  EXPECT_THAT(error(open_mcap, "MCAP"), HasSubstr("MCAP file of version 0"));
  const std::string magic = "#ROSBAG V2.0\n";
  EXPECT_THAT(error(open_ros1_bag, magic + raw(std::uint32_t{0xffffffff})),
              HasSubstr("expected records of at most 1073741824 bytes, got 4294967295"));
  EXPECT_THAT(error(open_ros1_bag, magic + with_length("junk") + with_length("")),
              HasSubstr("a record ends too early"));
  EXPECT_THAT(error(open_ros1_bag,
                    magic + ros1_record(2, with_length("conn=" + raw(std::uint32_t{1})), "")),
              HasSubstr("before its connection"));
  EXPECT_THAT(
      error(open_ros1_bag, magic + ros1_record(5,
                                               with_length("compression=rar") +
                                                   with_length("size=" + raw(std::uint32_t{9})),
                                               "x")),
      HasSubstr("compressed by bz2, lz4 or zstd, got 'rar'"));
  const std::string of_chunk =
      with_length("compression=none") + with_length("size=" + raw(std::uint32_t{9}));
  EXPECT_THAT(
      error(open_ros1_bag, magic + ros1_record(5, of_chunk, ros1_record(5, of_chunk, "inner"))),
      HasSubstr("a chunk has a chunk in it"));
  for (const std::string& method : methods({"bz2", "lz4"})) {
    std::string header = with_length("compression=" + method);
    header += with_length("size=" + raw(std::uint32_t{9}));
    std::string bag = magic;
    bag += ros1_record(5, header, "junk");
    EXPECT_THAT(error(open_ros1_bag, bag),
                HasSubstr("a chunk is broken: expected 9 bytes of " + method));
  }
}

TEST(Bag, FilesAreToldByTheirBytesAndErrorsNameThem) {
  const TemporaryFolder folder;
  const auto bag = folder.write("a.txt", ros1_bag("none"));
  EXPECT_TRUE(is_bag(bag));
  const auto reader = open_bag(bag);
  BagMessage message;
  EXPECT_TRUE(reader->next(message));
  const auto text = folder.write("b.bag", "hello");
  EXPECT_FALSE(is_bag(text));
  EXPECT_THAT(error_of([&] { open_bag(text); }), HasSubstr("b.bag: expected a ROS 1 bag"));
  const auto broken =
      folder.write("c.bag", "#ROSBAG V2.0\n" + with_length("junk") + with_length(""));
  const auto of_broken = open_bag(broken);
  EXPECT_THAT(error_of([&] { of_broken->next(message); }), HasSubstr("c.bag: a record"));
}

TEST(Bag, AFoldersFilesAreReadOneAfterAnother) {
  const TemporaryFolder folder;
  folder.write("bag/bag_10.mcap", mcap(""));
  folder.write("bag/bag_9.mcap", mcap(""));
  folder.write("bag/metadata.yaml", "rosbag2_bagfile_information:");
  const auto reader = open_bag(folder.path() / "bag");
  int messages = 0;
  for (BagMessage message; reader->next(message);) ++messages;
  EXPECT_EQ(messages, 6);
}

}  // namespace
}  // namespace diminish::ros
