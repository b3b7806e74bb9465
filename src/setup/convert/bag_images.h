#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diminish/camera_source.h"
#include "ros/bag/bag.h"
#include "ros/frame_tree.h"
#include "ros/messages.h"

namespace diminish {

/// A message of images, whichever of the two types it is. `sensor`: what its encoding says.
struct BagImage {
  Sensor sensor = Sensor::color;
  ros::Header header;
  std::optional<ros::ImageMessage> raw;
  std::optional<ros::CompressedImageMessage> compressed;
};
/// Nothing for other messages. Throws Error (input) where it is broken.
std::optional<BagImage> read_bag_image(const ros::BagMessage& message);

/// A topic of images in a bag.
struct BagStream {
  std::string topic, frame_id;
  Sensor sensor = Sensor::color;
  std::size_t images = 0;
  int width = 0, height = 0;  ///< of the first one
  std::optional<Intrinsics> lens;
  double depth_unit_m = 0.001;
};

/// What a bag holds, from its beginning to its end.
struct BagSurvey {
  std::vector<BagStream> streams;             ///< in the order of their first images
  std::map<std::string, std::string> others;  ///< topics of other messages, and their types
  ros::FrameTree frames;
};
/// Cost: reads the whole bag. Throws Error that names the file.
BagSurvey survey_bag(const std::filesystem::path& bag);

}  // namespace diminish
