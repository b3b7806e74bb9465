#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "diminish/rigid_transform.h"
#include "ros/message_reader.h"
#include "ros/message_writer.h"

namespace diminish::ros {

// ROS's messages, with the fields that it defines, in its order (std_msgs, sensor_msgs, tf2_msgs,
// diagnostic_msgs). `dds_type` is the type's name on the wire. `data` is a part of the message that
// was read, or the caller's pixels.

struct Header {
  double stamp_s = 0;  ///< on the sender's clock; ROS counts from 1970
  std::string frame_id;
};

struct ImageMessage {
  static constexpr const char* dds_type = "sensor_msgs::msg::dds_::Image_";
  static constexpr const char* ros_type = "sensor_msgs/msg/Image";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  bool is_big_endian = false;
  std::uint32_t step = 0;  ///< bytes from row to row
  std::span<const std::uint8_t> data;
};

struct CompressedImageMessage {
  static constexpr const char* dds_type = "sensor_msgs::msg::dds_::CompressedImage_";
  static constexpr const char* ros_type = "sensor_msgs/msg/CompressedImage";
  Header header;
  std::string format;
  std::span<const std::uint8_t> data;
};

struct CameraInfoMessage {
  static constexpr const char* dds_type = "sensor_msgs::msg::dds_::CameraInfo_";
  static constexpr const char* ros_type = "sensor_msgs/msg/CameraInfo";
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{}, r{};
  std::array<double, 12> p{};
  std::uint32_t binning_x = 0, binning_y = 0;
  std::uint32_t roi_x = 0, roi_y = 0, roi_height = 0, roi_width = 0;
  bool roi_is_rectified = false;
};

/// A transform takes coordinates in `child` to coordinates in `header.frame_id`.
struct TransformStamped {
  Header header;
  std::string child;
  RigidTransform parent_from_child;
};

struct TfMessage {
  static constexpr const char* dds_type = "tf2_msgs::msg::dds_::TFMessage_";
  static constexpr const char* ros_type = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms;
};

struct DiagnosticStatus {
  enum Level : std::uint8_t { ok, warn, error, stale };
  Level level = ok;
  std::string name, message, hardware_id;
  std::vector<std::array<std::string, 2>> values;  ///< key, value
};

struct DiagnosticArray {
  static constexpr const char* dds_type = "diagnostic_msgs::msg::dds_::DiagnosticArray_";
  static constexpr const char* ros_type = "diagnostic_msgs/msg/DiagnosticArray";
  Header header;
  std::vector<DiagnosticStatus> statuses;
};

/// What a camera saw at one moment: diminish's own message, of one camera node. Colour is a JPEG,
/// depth ROS's compressedDepth; one of the two may be empty.
struct RgbdMessage {
  static constexpr const char* dds_type = "diminish_msgs::msg::dds_::Rgbd_";
  static constexpr const char* ros_type = "diminish_msgs/msg/Rgbd";
  CompressedImageMessage color, depth;
  CameraInfoMessage color_info, depth_info;
  double depth_unit_m = 0.001;
  RigidTransform color_from_depth;
};

// Each throws Error (input) that says what was expected where a message is broken, has numbers that
// are not finite, or is larger than any camera's.
void read(MessageReader& reader, ImageMessage& message);
void read(MessageReader& reader, CompressedImageMessage& message);
void read(MessageReader& reader, CameraInfoMessage& message);
void read(MessageReader& reader, TfMessage& message);
void read(MessageReader& reader, DiagnosticArray& message);
void read(MessageReader& reader, RgbdMessage& message);

template <class Message>
Message read_message(std::span<const std::uint8_t> bytes, Wire wire = Wire::cdr) {
  Message message;
  MessageReader reader(bytes, wire);
  read(reader, message);
  return message;
}

void write(MessageWriter& writer, const ImageMessage& message);
void write(MessageWriter& writer, const CompressedImageMessage& message);
void write(MessageWriter& writer, const CameraInfoMessage& message);
void write(MessageWriter& writer, const TfMessage& message);
void write(MessageWriter& writer, const DiagnosticArray& message);
void write(MessageWriter& writer, const RgbdMessage& message);

template <class Message>
void write_message(const Message& message, std::vector<std::uint8_t>& bytes,
                   Wire wire = Wire::cdr) {
  MessageWriter writer(bytes, wire);
  write(writer, message);
}

}  // namespace diminish::ros
