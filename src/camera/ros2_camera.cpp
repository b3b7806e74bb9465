#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "camera/ros2_address.h"
#include "camera/ros2_devices.h"
#include "camera/sender_clock.h"
#include "dds/dds.h"
#include "diminish/camera_source.h"
#include "diminish/error.h"
#include "ros/camera_info.h"
#include "ros/compressed_depth.h"
#include "ros/frame_tree.h"
#include "ros/messages.h"
#include "ros/pixel_encodings.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

using dds::Delivery;
using Kind = Ros2Address::Kind;

/// Without a rig, images wait so long for their camera_info, which tells their lens.
constexpr double info_patience_s = 2;

/// What a subscribed topic is for.
enum class Role { color, depth, color_info, depth_info, rgbd, tf };

/// A camera that a ROS 2 node publishes.
class Ros2Camera : public CameraSource {
 public:
  Ros2Camera(const CameraUri& uri, const CameraRequest& request)
      : address_(parse_ros2_address(uri)),
        clock_(address_.clock),
        has_rig_(request.rig != nullptr),
        opened_s_(monotonic_now_s()),
        subscriptions_(dds::Node::open(address_.network)) {
    const RgbdCamera* const camera =
        request.rig != nullptr ? find_rgbd_camera(*request.rig, request.name) : nullptr;
    if (has_rig_ && !uri.has("rgbd")) take_local_images();
    wants_depth_ = request.name != "color" && (!camera || camera->measures_depth);
    if (camera) depth_unit_m_ = camera->depth_unit_m;
    if (!wants_depth_ && !address_.color && address_.rgbd.empty()) {
      uri.fail("expected color=TOPIC: " + request.name + " has no use for depth alone");
    }
    if (address_.color) add(*address_.color, Role::color, Role::color_info);
    if (address_.depth && wants_depth_) add(*address_.depth, Role::depth, Role::depth_info);
    if (!address_.rgbd.empty()) add<ros::RgbdMessage>(address_.rgbd, Role::rgbd, delivery());
    if (address_.uses_tf) {
      add<ros::TfMessage>("/tf", Role::tf, Delivery::reliable);
      add<ros::TfMessage>("/tf_static", Role::tf, Delivery::kept);
    }
  }

  Status read(CameraImage& image, std::chrono::milliseconds timeout) override {
    image.fault.clear();
    if (has_pending_depth_) return take_pending_depth(image);
    const double end_s = monotonic_now_s() + std::chrono::duration<double>(timeout).count();
    while (true) {
      const double left_s = std::max(0., end_s - monotonic_now_s());
      const std::chrono::milliseconds left(static_cast<int>(left_s * 1000));
      if (subscriptions_.take(received_, left) && take(image)) return Status::image;
      if (left_s == 0) return Status::nothing;
    }
  }

  std::size_t dropped() const override { return subscriptions_.lost(); }

  std::optional<Intrinsics> intrinsics(Sensor sensor) const override {
    return sensor == Sensor::color ? color_lens_ : depth_lens_;
  }

  std::optional<RigidTransform> color_from_depth() const override {
    if (address_.is_aligned || (!color_frame_.empty() && color_frame_ == depth_frame_)) {
      return RigidTransform{};
    }
    if (told_color_from_depth_) return told_color_from_depth_;
    return tree_.find(color_frame_, depth_frame_);
  }

  std::optional<CameraClock> clock() const override { return clock_.state(); }

 private:
  /// On the node's own machine its images as they are take less time than compressing them. The
  /// lenses, which come with the compressed ones, are known from the rig.
  void take_local_images() {
    if (address_.rgbd.empty() || !address_.network.is_within_machine()) return;
    const std::string base = address_.rgbd.substr(0, address_.rgbd.rfind('/'));
    address_.color = {.topic = base + "/color/image_raw"};
    address_.depth = {.topic = base + "/depth/image_raw"};
    address_.rgbd.clear();
  }
  Delivery delivery() const { return address_.is_reliable ? Delivery::reliable : Delivery::newest; }
  template <class Message>
  void add(const std::string& topic, Role role, Delivery delivery) {
    subscriptions_.add({topic, Message::dds_type}, delivery);
    topics_.emplace_back(topic, role);
  }
  void add(const Ros2Address::Stream& stream, Role image, Role info) {
    if (stream.kind == Kind::image) {
      add<ros::ImageMessage>(stream.topic, image, delivery());
    } else {
      add<ros::CompressedImageMessage>(stream.topic, image, delivery());
    }
    if (!has_rig_) add<ros::CameraInfoMessage>(stream.info, info, Delivery::newest);
  }

  /// Whether the message was an image.
  bool take(CameraImage& image) {
    const auto& [topic, role] = topics_[received_.topic];
    image.sensor = role == Role::depth ? Sensor::depth : Sensor::color;
    try {
      switch (role) {
        case Role::color:
          return take_color(image);
        case Role::depth:
          return take_depth(image);
        case Role::rgbd:
          return take_rgbd(image);
        case Role::color_info:
          color_lens_ = lens(address_.color->is_rectified);
          return false;
        case Role::depth_info:
          depth_lens_ = lens(address_.depth->is_rectified);
          return false;
        case Role::tf:
          tree_.add(ros::read_message<ros::TfMessage>(received_.bytes));
          return false;
      }
    } catch (const Error& error) {
      image.stamp_s = received_.arrival_s;
      image.fault = topic + ": " + error.what();
      return true;
    }
    return false;
  }

  std::optional<Intrinsics> lens(bool is_rectified) const {
    return lens(ros::read_message<ros::CameraInfoMessage>(received_.bytes), is_rectified);
  }
  /// Nothing where the camera is not calibrated.
  static std::optional<Intrinsics> lens(const ros::CameraInfoMessage& info, bool is_rectified) {
    if (info.k[0] == 0) return std::nullopt;
    return ros::intrinsics_of(info, is_rectified);
  }

  bool is_early(const std::optional<Intrinsics>& lens) const {
    return !has_rig_ && !lens && monotonic_now_s() < opened_s_ + info_patience_s;
  }

  double local_s(const ros::Header& header) {
    return clock_.local_s(header.stamp_s, received_.arrival_s, utc_from_monotonic_s());
  }

  bool take_color(CameraImage& image) {
    if (is_early(color_lens_)) return false;
    const auto read = [&](const auto& message) {
      image.stamp_s = local_s(message.header);
      color_frame_ = message.header.frame_id;
      ros::read_color(message, image.color);
    };
    if (address_.color->kind == Kind::image) {
      read(ros::read_message<ros::ImageMessage>(received_.bytes));
    } else {
      read(ros::read_message<ros::CompressedImageMessage>(received_.bytes));
    }
    return true;
  }

  bool take_depth(CameraImage& image) {
    if (is_early(depth_lens_)) return false;
    if (address_.depth->kind == Kind::image) {
      const auto message = ros::read_message<ros::ImageMessage>(received_.bytes);
      image.stamp_s = local_s(message.header);
      depth_frame_ = message.header.frame_id;
      ros::read_depth(message, depth_unit_m_, image.depth);
    } else {
      const auto message = ros::read_message<ros::CompressedImageMessage>(received_.bytes);
      image.stamp_s = local_s(message.header);
      depth_frame_ = message.header.frame_id;
      ros::read_compressed_depth(message, depth_unit_m_, image.depth);
    }
    return true;
  }

  bool take_rgbd(CameraImage& image) {
    const auto message = ros::read_message<ros::RgbdMessage>(received_.bytes);
    const bool has_color = !message.color.data.empty();
    has_pending_depth_ = wants_depth_ && !message.depth.data.empty();
    if (has_color && !has_rig_) color_lens_ = lens(message.color_info, false);
    if (has_pending_depth_) {
      pending_stamp_s_ = local_s(message.depth.header);
      told_color_from_depth_ = message.color_from_depth;
      if (!has_rig_) depth_lens_ = lens(message.depth_info, false);
    }
    if (!has_color) return has_pending_depth_ && take_pending_depth(image) == Status::image;
    image.stamp_s = local_s(message.color.header);
    ros::read_color(message.color, image.color);
    return true;
  }

  /// The depth of the message whose colour was taken last.
  Status take_pending_depth(CameraImage& image) {
    has_pending_depth_ = false;
    image.sensor = Sensor::depth;
    image.stamp_s = pending_stamp_s_;
    try {
      const auto message = ros::read_message<ros::RgbdMessage>(received_.bytes);
      ros::read_compressed_depth(message.depth, ros::millimetre_m, image.depth);
      ros::rescale_depth(message.depth_unit_m, depth_unit_m_, image.depth);
    } catch (const Error& error) {
      image.fault = address_.rgbd + ": " + error.what();
    }
    return Status::image;
  }

  Ros2Address address_;
  SenderClock clock_;
  bool has_rig_, wants_depth_ = false;
  double opened_s_;
  double depth_unit_m_ = ros::millimetre_m;
  dds::Subscriptions subscriptions_;
  std::vector<std::pair<std::string, Role>> topics_;
  dds::Received received_;
  std::optional<Intrinsics> color_lens_, depth_lens_;
  std::string color_frame_, depth_frame_;
  std::optional<RigidTransform> told_color_from_depth_;
  ros::FrameTree tree_;
  bool has_pending_depth_ = false;
  double pending_stamp_s_ = 0;
};

const bool ros2_camera_registered = Registry<CameraSource>::add(
    "ros2",
    {.open =
         [](const CameraUri& uri, const CameraRequest& request) {
           return std::make_unique<Ros2Camera>(uri, request);
         },
     .list = list_ros2_devices,
     .help =
         "ros2:/camera?color=color/image_raw&depth=depth/image_rect_raw  a ROS 2 camera; without "
         "topics a `diminish camera-node`"});

}  // namespace
}  // namespace diminish
