#include "dds/payload_type.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace diminish::dds {
namespace {

using Bytes = std::vector<std::uint8_t>;
using rtps::SerializedPayload_t;

constexpr std::size_t message_bytes = 4096;

TEST(PayloadType, AMessageComesAsItWasSent) {
  const PayloadType type("type", message_bytes);
  SerializedPayload_t payload(message_bytes);
  for (const std::size_t size : {4U, 20U, 32U, 33U, 4096U}) {
    Bytes sent(size), got(7);
    for (std::size_t i = 0; i < size; ++i) sent[i] = static_cast<std::uint8_t>(i * 31);
    ASSERT_TRUE(type.write(sent, payload));
    ASSERT_TRUE(type.read(payload, got));
    EXPECT_EQ(got, sent) << size;
  }
  Bytes large(message_bytes + 1), tiny(3);
  EXPECT_FALSE(type.write(large, payload));
  EXPECT_FALSE(type.write(tiny, payload));
}

TEST(PayloadType, WhatIsOverwrittenMeanwhileIsNotBelieved) {
  const PayloadType type("type", message_bytes);
  SerializedPayload_t payload(message_bytes);
  const Bytes sent(message_bytes, 5);
  ASSERT_TRUE(type.write(sent, payload));
  EXPECT_TRUE(PayloadType::is_still_there(sent, payload));
  // The next one has another stamp, after the four bytes of encapsulation.
  for (const std::size_t at : {4U, 8U, 15U}) {
    Bytes next = sent;
    next[at] = 6;
    ASSERT_TRUE(type.write(next, payload));
    EXPECT_FALSE(PayloadType::is_still_there(sent, payload)) << at;
  }
}

}  // namespace
}  // namespace diminish::dds
