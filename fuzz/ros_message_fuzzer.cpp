#include <cstddef>
#include <cstdint>
#include <vector>

#include "diminish/error.h"
#include "ros/camera_info.h"
#include "ros/compressed_depth.h"
#include "ros/frame_tree.h"
#include "ros/messages.h"
#include "ros/pixel_encodings.h"
#include "ros/transform_buffer.h"

using namespace diminish;

namespace {

template <class Message>
Message read(std::span<const std::uint8_t> bytes, ros::Wire wire) {
  auto message = ros::read_message<Message>(bytes, wire);
  std::vector<std::uint8_t> written;
  ros::write_message(message, written, wire);
  return message;
}

void use(std::uint8_t kind, std::span<const std::uint8_t> bytes, ros::Wire wire) {
  Image<Bgr> color;
  Image<std::uint16_t> depth;
  switch (kind % 8) {
    case 0:
      return ros::read_color(read<ros::ImageMessage>(bytes, wire), color);
    case 1:
      return ros::read_depth(read<ros::ImageMessage>(bytes, wire), .00025, depth);
    case 2:
      return ros::read_color(read<ros::CompressedImageMessage>(bytes, wire), color);
    case 3:
      return ros::read_compressed_depth(read<ros::CompressedImageMessage>(bytes, wire), .001,
                                        depth);
    case 4:
      ros::intrinsics_of(read<ros::CameraInfoMessage>(bytes, wire), bytes.size() % 2 == 0);
      return;
    case 5: {
      ros::FrameTree tree;
      const auto message = read<ros::TfMessage>(bytes, wire);
      tree.add(message);
      ros::TransformBuffer buffer;
      buffer.add(message, 0);
      for (const auto& transform : message.transforms) {
        tree.find("map", transform.child);
        buffer.find("map", transform.child, transform.header.stamp_s, 1);
      }
      buffer.add_static(message);
      for (const auto& transform : message.transforms) buffer.find("map", transform.child, 1, 1);
      return;
    }
    case 6:
      read<ros::DiagnosticArray>(bytes, wire);
      return;
    default: {
      const auto message = read<ros::RgbdMessage>(bytes, wire);
      ros::read_color(message.color, color);
      ros::read_compressed_depth(message.depth, message.depth_unit_m, depth);
    }
  }
}

}  // namespace

/// The first byte says which message the others are, and in which format.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    use(data[0], {data + 1, size - 1}, data[0] < 128 ? ros::Wire::cdr : ros::Wire::ros1);
  } catch (const Error&) {
  }
  return 0;
}
