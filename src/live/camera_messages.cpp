#include "live/camera_messages.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <type_traits>

#include "camera/sender_clock.h"
#include "core/mat.h"
#include "live/image_pairs.h"
#include "ros/camera_info.h"
#include "ros/compressed_depth.h"
#include "ros/pixel_encodings.h"

namespace diminish {
namespace {

constexpr const char* color_frame = "color_optical_frame";
constexpr const char* depth_frame = "depth_optical_frame";

}  // namespace

CameraMessages::CameraMessages(const std::shared_ptr<dds::Node>& node,
                               const std::function<std::string(const char*)>& topic,
                               dds::Delivery delivery, int jpeg_quality)
    : jpeg_quality_(jpeg_quality),
      color_{{node, {topic("color/image_raw"), ros::ImageMessage::dds_type}, delivery},
             {node,
              {topic("color/image_raw/compressed"), ros::CompressedImageMessage::dds_type},
              delivery},
             {node, {topic("color/camera_info"), ros::CameraInfoMessage::dds_type}, delivery}},
      depth_{{node, {topic("depth/image_raw"), ros::ImageMessage::dds_type}, delivery},
             {node,
              {topic("depth/image_raw/compressedDepth"), ros::CompressedImageMessage::dds_type},
              delivery},
             {node, {topic("depth/camera_info"), ros::CameraInfoMessage::dds_type}, delivery}},
      rgbd_(node, {topic("rgbd"), ros::RgbdMessage::dds_type}, delivery) {}

std::size_t CameraMessages::listeners() const {
  std::size_t count = rgbd_.listeners();
  for (const Topics* topics : {&color_, &depth_}) {
    count += topics->raw.listeners() + topics->compressed.listeners() + topics->info.listeners();
  }
  return count;
}

void CameraMessages::send(const CameraImage& image, const NodeLenses& lenses) {
  if (image.sensor == Sensor::color) {
    has_color_ = true;
    send(image.color, image.stamp_s, color_, lenses, waiting_color_);
  } else {
    has_depth_ = true;
    send(image.depth, image.stamp_s, depth_, lenses, waiting_depth_);
  }
}

template <class Pixel>
void CameraMessages::send(const Image<Pixel>& image, double stamp_s, Topics& topics,
                          const NodeLenses& lenses, std::optional<Compressed>& waiting) {
  constexpr bool is_color = std::is_same_v<Pixel, Bgr>;
  const ros::Header header{stamp_s + utc_from_monotonic_s(), is_color ? color_frame : depth_frame};
  const auto& lens = is_color ? lenses.color : lenses.depth;
  if (topics.info.listeners() > 0 && lens) {
    ros::CameraInfoMessage info = ros::camera_info(*lens);
    info.header = header;
    send(topics.info, info);
  }
  if (topics.raw.listeners() > 0) {
    ros::ImageMessage message = ros::image_message(image);
    Image<float> metres;
    if constexpr (!is_color) {
      if (lenses.depth_unit_m != ros::millimetre_m) {
        metres = ros::depth_in_metres(image, lenses.depth_unit_m);
        message = ros::image_message(metres);
      }
    }
    message.header = header;
    send(topics.raw, message);
  }
  const bool is_wanted_alone = topics.compressed.listeners() > 0;
  if (!is_wanted_alone && rgbd_.listeners() == 0) return;
  // The one before is still alone: the other sensor has none of its moment.
  if (waiting) send_moment(lenses);
  waiting = Compressed{};
  waiting->stamp_s = stamp_s;
  const double start_s = monotonic_now_s();
  compress(image, lenses, *waiting);
  compress_ms_ += (monotonic_now_s() - start_s) * 1e3;
  if (is_wanted_alone) {
    if (is_color || lenses.depth_unit_m == ros::millimetre_m) {
      send(topics.compressed, ros::CompressedImageMessage{header, waiting->format, waiting->bytes});
    }
  }
  const bool is_whole =
      has_color_ && has_depth_
          ? waiting_color_ && waiting_depth_ &&
                std::abs(waiting_color_->stamp_s - waiting_depth_->stamp_s) < moment_s
          : true;
  if (is_whole) send_moment(lenses);
}

void CameraMessages::compress(const Image<Bgr>& image, const NodeLenses&, Compressed& to) const {
  to.format = "bgr8; jpeg compressed bgr8";
  cv::imencode(".jpg", as_mat(image), to.bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg_quality_});
}

void CameraMessages::compress(const Image<std::uint16_t>& image, const NodeLenses&,
                              Compressed& to) const {
  to.format = ros::write_compressed_depth(image, to.bytes);
}

void CameraMessages::send_moment(const NodeLenses& lenses) {
  const double utc_s = utc_from_monotonic_s();
  ros::RgbdMessage message;
  if (waiting_color_) {
    message.color = {{waiting_color_->stamp_s + utc_s, color_frame},
                     waiting_color_->format,
                     waiting_color_->bytes};
    if (lenses.color) message.color_info = ros::camera_info(*lenses.color);
    color_bytes_ += waiting_color_->bytes.size();
  }
  if (waiting_depth_) {
    message.depth = {{waiting_depth_->stamp_s + utc_s, depth_frame},
                     waiting_depth_->format,
                     waiting_depth_->bytes};
    if (lenses.depth) message.depth_info = ros::camera_info(*lenses.depth);
    depth_bytes_ += waiting_depth_->bytes.size();
  }
  message.depth_unit_m = lenses.depth_unit_m;
  message.color_from_depth = lenses.color_from_depth;
  if (rgbd_.listeners() > 0) send(rgbd_, message);
  ++moments_;
  waiting_color_.reset();
  waiting_depth_.reset();
}

template <class Message>
void CameraMessages::send(dds::Publication& to, const Message& message) {
  ros::write_message(message, bytes_);
  to.send(bytes_);
}

}  // namespace diminish
