#include "remote/node_messages.h"

#include "diminish/error.h"
#include "diminish/validate.h"
#include "remote/node_fields.h"

namespace diminish {
namespace {

using namespace node_fields;
using ros::MessageReader;
using ros::MessageWriter;
using ros::Wire;

constexpr int most_samples = 100'000;
constexpr double longest_wait_s = 60;
constexpr int most_user_pixels = 10'000'000;

void read_head(MessageReader& reader, NodeHead& head) {
  const auto found = reader.number<std::uint32_t>();
  if (found != version) {
    throw Error(Error::input,
                "expected the messages of this version of diminish: the node's and "
                "the user's differ");
  }
  const auto topic = reader.number<std::uint8_t>();
  expect(topic <= static_cast<std::uint8_t>(NodeTopic::layer), "expected a glance or a layer");
  head.topic = static_cast<NodeTopic>(topic);
  head.user = reader.number<std::uint64_t>();
  head.frame = reader.number<std::uint64_t>();
}

}  // namespace

NodeMessage<NodeHead> open_question(std::span<const std::uint8_t> bytes) {
  NodeMessage<NodeHead> message{{}, MessageReader(bytes, Wire::cdr)};
  read_head(message.rest, message.head);
  return message;
}

NodeMessage<AnswerHead> open_answer(std::span<const std::uint8_t> bytes) {
  NodeMessage<AnswerHead> message{{}, MessageReader(bytes, Wire::cdr)};
  read_head(message.rest, message.head);
  message.head.asked_s = finite(message.rest);
  message.head.received_s = finite(message.rest);
  message.head.sent_s = finite(message.rest);
  message.head.problem = message.rest.text();
  return message;
}

std::vector<std::uint8_t> write_question(const NodeHead& head, const GlanceQuestion& question) {
  std::vector<std::uint8_t> bytes;
  MessageWriter writer(bytes, Wire::cdr);
  write(writer, head);
  writer.doubles<4>(
      {question.asked_s, question.stamp_s, question.tolerance_s, question.patience_s});
  write(writer, question.camera.color);
  write(writer, question.camera.depth);
  writer.number(question.camera.depth_unit_m);
  write(writer, question.camera.color_from_depth);
  write(writer, question.user);
  writer.text(question.wishes.marker_dictionary);
  for (const int spacing : question.wishes.spacings_px) writer.number(spacing);
  writer.number(question.wishes.samples);
  writer.number(std::uint8_t{question.wishes.exact});
  return bytes;
}

void read(MessageReader& reader, GlanceQuestion& question) {
  question.asked_s = finite(reader);
  question.stamp_s = finite(reader);
  question.tolerance_s = within(reader, 0, longest_wait_s, "expected a tolerance up to a minute");
  question.patience_s = within(reader, 0, longest_wait_s, "expected patience up to a minute");
  question.camera.name = "camera";
  question.camera.color = read_lens(reader);
  question.camera.depth = read_lens(reader);
  question.camera.depth_unit_m = finite(reader);
  question.camera.color_from_depth = read_transform(reader);
  question.user = read_lens(reader);
  expect(question.user.width * question.user.height <= most_user_pixels,
         "expected a user's picture of at most 10 million pixels");
  question.wishes.marker_dictionary = reader.text();
  for (int& spacing : question.wishes.spacings_px) {
    spacing = integer(reader, 0, largest_side_px, "expected a spacing of pixels");
  }
  question.wishes.samples = integer(reader, 1, most_samples, "expected at most 100000 samples");
  question.wishes.exact = flag(reader);
  Rig rig;
  rig.color = question.user;
  rig.rgbd.push_back(question.camera);
  validate(rig);
}

std::vector<std::uint8_t> write_answer(const AnswerHead& head) {
  std::vector<std::uint8_t> bytes;
  begin_answer(bytes, head);
  return bytes;
}

}  // namespace diminish
