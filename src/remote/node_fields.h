#pragma once

#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/rigid_transform.h"
#include "remote/node_messages.h"
#include "ros/message_reader.h"
#include "ros/message_writer.h"

namespace diminish::node_fields {

// What the messages of node_messages.h are made of. Readers throw Error (input).

/// Changes whenever a field does.
inline constexpr std::uint32_t version = 2;
inline constexpr int largest_side_px = 16384;

void expect(bool condition, const char* what);
double finite(ros::MessageReader& reader);
double within(ros::MessageReader& reader, double least, double most, const char* what);
/// A count or a size.
int integer(ros::MessageReader& reader, int least, int most, const char* what);
bool flag(ros::MessageReader& reader);

/// Bit for bit, where a quaternion would round.
void write(ros::MessageWriter& writer, const RigidTransform& transform);
RigidTransform read_transform(ros::MessageReader& reader);

void write(ros::MessageWriter& writer, const Intrinsics& lens);
Intrinsics read_lens(ros::MessageReader& reader);

void write(ros::MessageWriter& writer, const Rect& rect);
/// A part of `whole`; may be empty. what: for the error.
Rect read_rect(ros::MessageReader& reader, const Rect& whole, const char* what);

void write(ros::MessageWriter& writer, const NodeHead& head);
/// To be sent at once.
ros::MessageWriter begin_answer(std::vector<std::uint8_t>& bytes, const AnswerHead& head);

/// What `write` appends.
template <class Write>
std::vector<std::uint8_t> bytes_of(const Write& write) {
  std::vector<std::uint8_t> bytes;
  write(bytes);
  return bytes;
}

}  // namespace diminish::node_fields
