#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dds/dds.h"
#include "diminish/camera_source.h"
#include "ros/messages.h"

namespace diminish {

/// What a camera node knows of its camera's sensors.
struct NodeLenses {
  std::optional<Intrinsics> color, depth;
  double depth_unit_m = 0.001;
  RigidTransform color_from_depth;
};

/// A camera's images on their topics: alone, compressed, and a moment's two in one message.
class CameraMessages {
 public:
  /// topic: below the node's base, checked.
  CameraMessages(const std::shared_ptr<dds::Node>& node,
                 const std::function<std::string(const char*)>& topic, dds::Delivery delivery,
                 int jpeg_quality);

  /// Sends an image to those who listen. An image waits for the other sensor's of its moment, for
  /// the combined message, until the next of its own.
  void send(const CameraImage& image, const NodeLenses& lenses);

  std::size_t listeners() const;
  std::size_t moments() const { return moments_; }
  std::size_t color_bytes() const { return color_bytes_; }
  std::size_t depth_bytes() const { return depth_bytes_; }
  double compress_ms() const { return compress_ms_; }

 private:
  struct Compressed {
    double stamp_s = 0;  ///< on the monotonic clock
    std::string format;
    std::vector<std::uint8_t> bytes;
  };
  struct Topics {
    dds::Publication raw, compressed, info;
  };
  template <class Pixel>
  void send(const Image<Pixel>& image, double stamp_s, Topics& topics, const NodeLenses& lenses,
            std::optional<Compressed>& waiting);
  void compress(const Image<Bgr>& image, const NodeLenses&, Compressed& to) const;
  void compress(const Image<std::uint16_t>& image, const NodeLenses&, Compressed& to) const;
  void send_moment(const NodeLenses& lenses);
  template <class Message>
  void send(dds::Publication& to, const Message& message);

  int jpeg_quality_;
  Topics color_, depth_;
  dds::Publication rgbd_;
  bool has_color_ = false, has_depth_ = false;
  std::optional<Compressed> waiting_color_, waiting_depth_;
  std::size_t moments_ = 0, color_bytes_ = 0, depth_bytes_ = 0;
  double compress_ms_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace diminish
