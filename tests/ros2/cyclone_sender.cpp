// A ROS 2 camera by Cyclone DDS, which knows nothing of diminish: the tests' counterpart.
//   cyclone_sender DOMAIN BASE    sends 20 images a second of each kind below BASE, until killed
// Pixel i of colour is i % 251 in each byte, of depth 500 + i.

#include <dds/dds.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "ros_messages.h"

namespace {

constexpr std::uint32_t width = 64, height = 48;

dds_entity_t checked(dds_entity_t entity) {
  if (entity >= 0) return entity;
  std::fprintf(stderr, "cyclone_sender: %s\n", dds_strretcode(-entity));
  std::exit(1);
}

dds_entity_t writer(dds_entity_t participant, const dds_topic_descriptor_t* type,
                    const std::string& name, bool is_kept = false) {
  const dds_entity_t topic =
      checked(dds_create_topic(participant, type, name.c_str(), nullptr, nullptr));
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, is_kept ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_SECS(1));
  dds_qset_durability(qos, is_kept ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 5);
  const dds_entity_t made = checked(dds_create_writer(participant, topic, qos, nullptr));
  dds_delete_qos(qos);
  return made;
}

std_msgs_msg_dds__Header_ header(const char* frame) {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return {{static_cast<std::int32_t>(now.tv_sec), static_cast<std::uint32_t>(now.tv_nsec)},
          const_cast<char*>(frame)};
}

template <class Sequence, class Values>
void point_to(Sequence& sequence, Values& values) {
  sequence._maximum = sequence._length = static_cast<std::uint32_t>(values.size());
  sequence._buffer = values.data();
  sequence._release = false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string base = std::string("rt") + argv[2];
  const dds_entity_t participant = checked(
      dds_create_participant(static_cast<dds_domainid_t>(std::atoi(argv[1])), nullptr, nullptr));
  const auto color =
      writer(participant, &sensor_msgs_msg_dds__Image__desc, base + "/color/image_raw");
  const auto depth =
      writer(participant, &sensor_msgs_msg_dds__Image__desc, base + "/depth/image_raw");
  const auto info =
      writer(participant, &sensor_msgs_msg_dds__CameraInfo__desc, base + "/color/camera_info");
  const auto depth_info =
      writer(participant, &sensor_msgs_msg_dds__CameraInfo__desc, base + "/depth/camera_info");
  const auto tf = writer(participant, &tf2_msgs_msg_dds__TFMessage__desc, "rt/tf_static", true);

  geometry_msgs_msg_dds__TransformStamped_ link{};
  link.header = header("color_frame");
  link.child_frame_id = const_cast<char*>("depth_frame");
  link.transform.translation = {.05, -.01, .002};
  link.transform.rotation = {0, 0, .6, .8};
  std::vector<geometry_msgs_msg_dds__TransformStamped_> links = {link};
  tf2_msgs_msg_dds__TFMessage_ transforms{};
  point_to(transforms.transforms, links);
  checked(dds_write(tf, &transforms));

  std::vector<std::uint8_t> color_bytes(width * height * 3), depth_bytes(width * height * 2);
  for (std::size_t i = 0; i < color_bytes.size(); ++i) {
    color_bytes[i] = static_cast<std::uint8_t>(i / 3 % 251);
  }
  for (std::size_t i = 0; i < depth_bytes.size(); i += 2) {
    const std::size_t value = 500 + i / 2;
    depth_bytes[i] = static_cast<std::uint8_t>(value);
    depth_bytes[i + 1] = static_cast<std::uint8_t>(value >> 8);
  }
  std::vector<double> distortion = {.1, -.05, .001, -.002, .01};
  while (true) {
    sensor_msgs_msg_dds__Image_ image{};
    image.header = header("color_frame");
    image.height = height;
    image.width = width;
    image.encoding = const_cast<char*>("bgr8");
    image.step = width * 3;
    point_to(image.data, color_bytes);
    checked(dds_write(color, &image));
    image.header = header("depth_frame");
    image.encoding = const_cast<char*>("16UC1");
    image.step = width * 2;
    point_to(image.data, depth_bytes);
    checked(dds_write(depth, &image));
    sensor_msgs_msg_dds__CameraInfo_ lens{};
    lens.header = header("color_frame");
    lens.height = height;
    lens.width = width;
    lens.distortion_model = const_cast<char*>("plumb_bob");
    point_to(lens.d, distortion);
    lens.k[0] = 61;
    lens.k[2] = 31.5;
    lens.k[4] = 62;
    lens.k[5] = 23.5;
    lens.k[8] = 1;
    checked(dds_write(info, &lens));
    lens.k[0] = 55;
    checked(dds_write(depth_info, &lens));
    usleep(50'000);
  }
}
