#include "setup/convert/bag_images.h"

#include <algorithm>
#include <map>

#include "diminish/error.h"
#include "ros/camera_info.h"
#include "ros/compressed_depth.h"
#include "ros/pixel_encodings.h"

namespace diminish {
namespace {

/// What stands before the last `parts` slashes.
std::string above(const std::string& topic, int parts) {
  std::string result = topic;
  for (int i = 0; i < parts; ++i) result = result.substr(0, result.rfind('/'));
  return result;
}

/// Where a driver may put the camera_info of an image's topic: ROS's place, and RealSense's.
std::vector<std::string> info_topics(const std::string& image) {
  const bool is_compressed = image.ends_with("/compressed") || image.ends_with("/compressedDepth");
  const std::string raw = is_compressed ? above(image, 1) : image;
  return {above(raw, 1) + "/camera_info", above(raw, 2) + "/info/camera_info"};
}

bool is_rectified(const std::string& image) {
  return image.find("/image_rect") != std::string::npos;
}

/// RealSense tells a sensor's unit as an option: "/device_0/sensor_0/option/Depth_Units/value".
constexpr const char* unit_option = "/option/Depth_Units/value";

void measure(const BagImage& image, BagStream& stream) {
  if (image.raw) {
    stream.width = static_cast<int>(image.raw->width);
    stream.height = static_cast<int>(image.raw->height);
  } else if (image.sensor == Sensor::color) {
    Image<Bgr> color;
    ros::read_color(*image.compressed, color);
    stream.width = color.width();
    stream.height = color.height();
  } else {
    Image<std::uint16_t> depth;
    ros::read_compressed_depth(*image.compressed, ros::millimetre_m, depth);
    stream.width = depth.width();
    stream.height = depth.height();
  }
}

}  // namespace

std::optional<BagImage> read_bag_image(const ros::BagMessage& message) {
  BagImage image;
  if (message.type == ros::ImageMessage::ros_type) {
    image.raw = ros::read_message<ros::ImageMessage>(message.bytes, message.wire);
    image.header = image.raw->header;
    image.sensor = ros::is_depth_encoding(image.raw->encoding) ? Sensor::depth : Sensor::color;
  } else if (message.type == ros::CompressedImageMessage::ros_type) {
    image.compressed = ros::read_message<ros::CompressedImageMessage>(message.bytes, message.wire);
    image.header = image.compressed->header;
    image.sensor = image.compressed->format.find("compressedDepth") != std::string::npos
                       ? Sensor::depth
                       : Sensor::color;
  } else {
    return std::nullopt;
  }
  if (image.header.stamp_s == 0) image.header.stamp_s = message.stamp_s;
  return image;
}

BagSurvey survey_bag(const std::filesystem::path& bag) {
  BagSurvey survey;
  std::map<std::string, ros::CameraInfoMessage> infos;
  std::map<std::string, double> units;
  const auto reader = ros::open_bag(bag);
  for (ros::BagMessage message; reader->next(message);) {
    try {
      if (message.type == ros::CameraInfoMessage::ros_type) {
        if (infos.contains(message.topic)) continue;
        infos[message.topic] =
            ros::read_message<ros::CameraInfoMessage>(message.bytes, message.wire);
      } else if (message.type == ros::TfMessage::ros_type) {
        survey.frames.add(ros::read_message<ros::TfMessage>(message.bytes, message.wire));
      } else if (message.topic.ends_with(unit_option)) {
        units[message.topic] = ros::MessageReader(message.bytes, message.wire).number<float>();
      } else if (const auto image = read_bag_image(message)) {
        const auto known =
            std::find_if(survey.streams.begin(), survey.streams.end(),
                         [&](const BagStream& stream) { return stream.topic == message.topic; });
        if (known != survey.streams.end()) {
          ++known->images;
          continue;
        }
        BagStream stream;
        stream.topic = message.topic;
        stream.sensor = image->sensor;
        stream.frame_id = image->header.frame_id;
        measure(*image, stream);
        stream.images = 1;
        survey.streams.push_back(std::move(stream));
        continue;
      }
      survey.others.emplace(message.topic, message.type);
    } catch (const Error&) {
      // What is broken is counted when it is converted.
    }
  }
  for (BagStream& stream : survey.streams) {
    for (const std::string& topic : info_topics(stream.topic)) {
      const auto info = infos.find(topic);
      if (info == infos.end() || info->second.k[0] == 0) continue;
      const Intrinsics lens = ros::intrinsics_of(info->second, is_rectified(stream.topic));
      if (lens.width == stream.width && lens.height == stream.height) stream.lens = lens;
    }
    const auto unit = units.find(above(stream.topic, 3) + unit_option);
    if (unit != units.end() && unit->second > 0 && unit->second < 1) {
      stream.depth_unit_m = unit->second;
    }
  }
  return survey;
}

}  // namespace diminish
