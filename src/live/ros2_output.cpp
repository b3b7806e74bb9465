#include "diminish/ros2_output.h"

#include <chrono>
#include <optional>

#include "camera/ros2_address.h"
#include "camera/sender_clock.h"
#include "dds/dds.h"
#include "live/frame_forwarder.h"
#include "live/session_diagnostics.h"
#include "ros/camera_info.h"
#include "ros/pixel_encodings.h"

namespace diminish {
namespace {

using dds::Delivery;

constexpr double diagnostics_period_s = 1;
constexpr const char* frame_id = "diminish_color_optical_frame";

}  // namespace

struct Ros2Output::Implementation {
  Implementation(const LiveSession& of, const CameraUri& uri)
      : session(of),
        target(uri.text),
        node(dds::Node::open(parse_ros2_network(uri))),
        delivery(uri.has("reliable") ? Delivery::reliable : Delivery::newest),
        picture(node, topic<ros::ImageMessage>(uri, "image"), delivery),
        mask(node, topic<ros::ImageMessage>(uri, "mask"), delivery),
        provenance(node, topic<ros::ImageMessage>(uri, "provenance"), delivery),
        info(node, topic<ros::CameraInfoMessage>(uri, "camera_info"), delivery),
        diagnostics(node, {"/diagnostics", ros::DiagnosticArray::dds_type}, Delivery::reliable),
        forwarder(of, [this](const LiveFrame& frame) { send(frame); }) {}

  template <class Message>
  static dds::Topic topic(const CameraUri& uri, const std::string& name) {
    return {ros2_topic(uri, uri.target, name), Message::dds_type};
  }

  void send(const LiveFrame& frame) {
    const double utc_s = utc_from_monotonic_s();
    const ros::Header header{frame.input.stamp_s + utc_s, frame_id};
    send_image(picture, frame.result.picture, header);
    send_image(mask, frame.result.mask, header);
    send_image(provenance, frame.result.provenance, header);
    if (info.listeners() > 0) {
      ros::CameraInfoMessage lens = ros::camera_info(session.rig().color);
      lens.header = header;
      send(info, lens);
    }
    const double now_s = monotonic_now_s();
    if (now_s < next_diagnostics_s || diagnostics.listeners() == 0) return;
    next_diagnostics_s = now_s + diagnostics_period_s;
    ros::DiagnosticArray state = diagnostics_of(session.status());
    state.header.stamp_s = now_s + utc_s;
    send(diagnostics, state);
  }
  template <class Pixel>
  void send_image(dds::Publication& to, const Image<Pixel>& image, const ros::Header& header) {
    if (image.empty() || to.listeners() == 0) return;
    ros::ImageMessage message = ros::image_message(image);
    message.header = header;
    send(to, message);
  }
  template <class Message>
  void send(dds::Publication& to, const Message& message) {
    ros::write_message(message, bytes);
    to.send(bytes);
  }

  const LiveSession& session;
  std::string target;
  std::shared_ptr<dds::Node> node;
  Delivery delivery;
  dds::Publication picture, mask, provenance, info, diagnostics;
  double next_diagnostics_s = 0;
  std::vector<std::uint8_t> bytes;
  FrameForwarder forwarder;  ///< last: it uses all of the above
};

Ros2Output::Ros2Output(const LiveSession& session, const std::string& target) {
  const CameraUri uri = parse_camera_uri("ros2:" + target);
  uri.expect_parameters({"domain", "interface", "transport", "reliable", "keys", "mbits"});
  implementation_ = std::make_unique<Implementation>(session, uri);
}

Ros2Output::~Ros2Output() = default;

std::string Ros2Output::problem() const {
  const std::string what = implementation_->forwarder.problem();
  return what.empty() ? what : implementation_->target + ": " + what;
}

}  // namespace diminish
