// Reads a topic by Cyclone DDS, which knows nothing of diminish: the tests' counterpart.
//   cyclone_receiver DOMAIN KIND TOPIC    one message, in a line of text; fails after 30 s without
//   one
// KIND: image (its size, encoding and the sum of its bytes), info, compressed, diagnostics.

#include <dds/dds.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "ros_messages.h"

namespace {

dds_entity_t checked(dds_entity_t entity) {
  if (entity >= 0) return entity;
  std::fprintf(stderr, "cyclone_receiver: %s\n", dds_strretcode(-entity));
  std::exit(1);
}

template <class Bytes>
unsigned long long sum(const Bytes& bytes) {
  unsigned long long total = 0;
  for (std::uint32_t i = 0; i < bytes._length; ++i) total += bytes._buffer[i];
  return total;
}

void print(const sensor_msgs_msg_dds__Image_& image) {
  std::printf("%s %ux%u %s step %u bytes %u sum %llu stamp %d\n", image.header.frame_id,
              image.width, image.height, image.encoding, image.step, image.data._length,
              sum(image.data), image.header.stamp.sec);
}
void print(const sensor_msgs_msg_dds__CompressedImage_& image) {
  std::printf("%s '%s' bytes %u\n", image.header.frame_id, image.format, image.data._length);
}
void print(const sensor_msgs_msg_dds__CameraInfo_& info) {
  std::printf("%ux%u %s d %u fx %g cx %g fy %g cy %g p0 %g\n", info.width, info.height,
              info.distortion_model, info.d._length, info.k[0], info.k[2], info.k[4], info.k[5],
              info.p[0]);
}
void print(const diagnostic_msgs_msg_dds__DiagnosticArray_& state) {
  for (std::uint32_t i = 0; i < state.status._length; ++i) {
    const auto& status = state.status._buffer[i];
    std::printf("[%u] %s: %s, %u values; ", status.level, status.name, status.message,
                status.values._length);
  }
  std::printf("\n");
}

template <class Message>
int receive(dds_domainid_t domain, const dds_topic_descriptor_t* type, const std::string& name) {
  const dds_entity_t participant = checked(dds_create_participant(domain, nullptr, nullptr));
  const dds_entity_t topic =
      checked(dds_create_topic(participant, type, name.c_str(), nullptr, nullptr));
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  const dds_entity_t reader = checked(dds_create_reader(participant, topic, qos, nullptr));
  dds_delete_qos(qos);
  for (int i = 0; i < 3000; ++i) {
    void* samples[1] = {nullptr};
    dds_sample_info_t info;
    if (checked(dds_take(reader, samples, &info, 1, 1)) > 0 && info.valid_data) {
      print(*static_cast<const Message*>(samples[0]));
      return 0;
    }
    usleep(10'000);
  }
  std::fprintf(stderr, "cyclone_receiver: nothing on %s\n", name.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto domain = static_cast<dds_domainid_t>(std::atoi(argv[1]));
  const std::string topic = std::string("rt") + argv[3];
  const std::string kind = argv[2];
  if (kind == "image") {
    return receive<sensor_msgs_msg_dds__Image_>(domain, &sensor_msgs_msg_dds__Image__desc, topic);
  }
  if (kind == "compressed") {
    return receive<sensor_msgs_msg_dds__CompressedImage_>(
        domain, &sensor_msgs_msg_dds__CompressedImage__desc, topic);
  }
  if (kind == "info") {
    return receive<sensor_msgs_msg_dds__CameraInfo_>(domain, &sensor_msgs_msg_dds__CameraInfo__desc,
                                                     topic);
  }
  return receive<diagnostic_msgs_msg_dds__DiagnosticArray_>(
      domain, &diagnostic_msgs_msg_dds__DiagnosticArray__desc, topic);
}
