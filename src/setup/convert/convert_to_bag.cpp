#include <algorithm>
#include <memory>

#include "diminish/error.h"
#include "diminish/frame_source.h"
#include "ros/camera_info.h"
#include "ros/messages.h"
#include "ros/pixel_encodings.h"
#include "setup/convert/bag_writer.h"
#include "setup/convert/convert.h"
#include "source/image_file.h"
#include "source/image_header.h"
#include "source/image_stream.h"

namespace diminish {
namespace {

/// A stream of the recording and where its messages go.
struct Part {
  std::string name;   ///< of its list: "rgbd0_depth"
  std::string topic;  ///< "/rgbd0/depth"
  std::string frame_id;
  Intrinsics lens;
  bool is_depth = false;
  double unit_m = 0.001;
};

std::vector<Part> parts_of(const Rig& rig) {
  std::vector<Part> parts = {{"color", "/color", "color", rig.color, false, 0}};
  for (const RgbdCamera& camera : rig.rgbd) {
    parts.push_back({camera.name + "_color", "/" + camera.name + "/color", camera.name + "_color",
                     camera.color, false, 0});
    if (!camera.measures_depth) continue;
    parts.push_back({camera.name + "_depth", "/" + camera.name + "/depth", camera.name + "_depth",
                     camera.depth, true, camera.depth_unit_m});
  }
  return parts;
}

class Writer {
 public:
  Writer(const std::filesystem::path& recording, const std::filesystem::path& bag)
      : recording_(recording),
        bag_(bag.extension() == ".mcap" ? make_mcap(bag) : make_sqlite_bag(bag)) {}

  void write_transforms(const Rig& rig, double stamp_s) {
    ros::TfMessage tf;
    for (const RgbdCamera& camera : rig.rgbd) {
      if (!camera.measures_depth) continue;
      tf.transforms.push_back(
          {{stamp_s, camera.name + "_color"}, camera.name + "_depth", camera.color_from_depth});
    }
    if (!tf.transforms.empty()) write("/tf_static", tf, stamp_s);
  }

  std::size_t write(const Part& part) {
    const std::filesystem::path list = recording_ / (part.name + ".txt");
    if (part.is_depth) {
      ImageStream<std::uint16_t> stream(list, part.lens, EmptyList::is_no_images);
      Image<std::uint16_t> depth;
      for (std::size_t i = 0; i < stream.entries().size(); ++i) {
        stream.read(i, depth);
        ros::rescale_depth(part.unit_m, ros::millimetre_m, depth);
        write_image(part, stream.entries()[i].stamp_s, ros::image_message(depth));
      }
      return stream.entries().size();
    }
    ImageStream<Bgr> stream(list, part.lens, EmptyList::is_no_images);
    Image<Bgr> color;
    for (std::size_t i = 0; i < stream.entries().size(); ++i) {
      const StreamEntry& entry = stream.entries()[i];
      const auto bytes =
          entry.frame ? std::vector<std::uint8_t>() : read_bytes(recording_ / entry.file);
      if (is_jpeg(bytes)) {
        ros::CompressedImageMessage message{
            {entry.stamp_s, part.frame_id}, "bgr8; jpeg compressed bgr8", bytes};
        write(part.topic + "/image_raw/compressed", message, entry.stamp_s);
        write_info(part, entry.stamp_s);
        continue;
      }
      stream.read(i, color);
      write_image(part, entry.stamp_s, ros::image_message(color));
    }
    return stream.entries().size();
  }
  void finish() { bag_->finish(); }

 private:
  void write_image(const Part& part, double stamp_s, ros::ImageMessage message) {
    message.header = {stamp_s, part.frame_id};
    write(part.topic + "/image_raw", message, stamp_s);
    write_info(part, stamp_s);
  }
  void write_info(const Part& part, double stamp_s) {
    ros::CameraInfoMessage info = ros::camera_info(part.lens);
    info.header = {stamp_s, part.frame_id};
    write(part.topic + "/camera_info", info, stamp_s);
  }
  template <class Message>
  void write(const std::string& topic, const Message& message, double stamp_s) {
    ros::write_message(message, bytes_);
    bag_->write(topic, Message::ros_type, stamp_s, bytes_);
  }

  std::filesystem::path recording_;
  std::unique_ptr<BagWriter> bag_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

Conversion convert_to_bag(const std::filesystem::path& recording,
                          const std::filesystem::path& bag) {
  const Rig rig = load_rig(recording / "rig.yaml");
  const auto color = load_stream_list(recording / "color.txt");
  Writer writer(recording, bag);
  writer.write_transforms(rig, color.front().stamp_s);
  Conversion conversion;
  for (const Part& part : parts_of(rig)) {
    conversion.streams.push_back({part.name, part.topic, writer.write(part)});
  }
  writer.finish();
  return conversion;
}

}  // namespace diminish
