#pragma once

#include <cstdint>
#include <string_view>

// Source: mcap.dev/spec, version 0.
namespace diminish::ros::mcap {

/// What a file begins and ends with.
inline constexpr std::string_view magic = "\x89MCAP0\r\n";

/// Kinds of records.
enum Op : std::uint8_t {
  header_op = 1,
  footer_op = 2,
  schema_op = 3,
  channel_op = 4,
  message_op = 5,
  chunk_op = 6,
  message_index_op = 7,
  chunk_index_op = 8,
  statistics_op = 11,
  data_end_op = 15,
};

}  // namespace diminish::ros::mcap
