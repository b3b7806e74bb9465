#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "diminish/occlusion_masks.h"
#include "diminish/remote_images.h"
#include "diminish/rig.h"
#include "remote/glance_maker.h"
#include "ros/message_reader.h"

namespace diminish {

// What the user's machine and a node that draws say to one another: for each frame two questions
// and two answers. docs/render-node.md has the fields. All readers throw Error (input) that says
// what was expected; sizes are those that the reader knows already, or bounded.

/// The type's names on the wire.
inline constexpr const char* node_question_type = "diminish_msgs::msg::dds_::NodeQuestion_";
inline constexpr const char* node_answer_type = "diminish_msgs::msg::dds_::NodeAnswer_";

enum class NodeTopic : std::uint8_t { glance, layer };

/// In front of every message.
struct NodeHead {
  NodeTopic topic = NodeTopic::glance;
  std::uint64_t user = 0;   ///< chosen at random: one of several that a node draws for
  std::uint64_t frame = 0;  ///< the user's count
};

/// For a glance.
struct GlanceQuestion {
  double asked_s = 0;      ///< the user's clock, to be sent back
  double stamp_s = 0;      ///< of the frame, on the node's clock
  double tolerance_s = 0;  ///< images up to so much earlier or later are of the frame
  double patience_s = 0;   ///< how long the question may wait for them
  RgbdCamera camera;       ///< the lenses that the user's rig says; without a name
  Intrinsics user;         ///< the user's colour camera
  GlanceWishes wishes;
};

/// How a layer travels.
struct LayerCoding {
  /// Within one machine: as it is in memory, if it has at most three million pixels. Many bytes,
  /// and hardly any time.
  bool raw = false;
  int jpeg_quality = 92;       ///< otherwise; 0: colours without loss
  double depth_unit_m = 2e-4;  ///< otherwise: the least step of its depth; 0: without loss

  bool is_exact() const { return raw || depth_unit_m == 0; }
};

/// For a layer. How the images are to be drawn, and sent.
struct LayerQuestion {
  RigidTransform color_from_depth;
  Mask rgbd_color, rgbd_depth;
  TiledRegion region;
  Options options;  ///< those that the drawing reads
  LayerCoding coding;

  RemoteDrawing drawing() const {
    return {color_from_depth, rgbd_color, rgbd_depth, region, options};
  }
};

/// In front of every answer's contents.
struct AnswerHead : NodeHead {
  double asked_s = 0;  ///< the question's
  /// When the question came and when this was written, on the node's clock.
  double received_s = 0, sent_s = 0;
  std::string problem;  ///< why there is nothing else
};

std::vector<std::uint8_t> write_question(const NodeHead& head, const GlanceQuestion& question);
std::vector<std::uint8_t> write_question(const NodeHead& head, const RemoteDrawing& drawing,
                                         const LayerCoding& coding);

/// A message whose head has been read.
template <class Head>
struct NodeMessage {
  Head head;
  ros::MessageReader rest;
};
/// bytes must outlive the result.
NodeMessage<NodeHead> open_question(std::span<const std::uint8_t> bytes);
NodeMessage<AnswerHead> open_answer(std::span<const std::uint8_t> bytes);

void read(ros::MessageReader& reader, GlanceQuestion& question);
/// asked: the glance's question of the same frame.
void read(ros::MessageReader& reader, const GlanceQuestion& asked, LayerQuestion& question);

/// Stamps are the node's.
std::vector<std::uint8_t> write_answer(const AnswerHead& head, const Glance& glance,
                                       const GlanceQuestion& asked);
/// layer: its colours may be changed where it has no depth. answer: its memory is used again.
void write_answer(const AnswerHead& head, RemoteLayer& layer, const LayerCoding& coding,
                  std::vector<std::uint8_t>& answer);
/// With a problem alone.
std::vector<std::uint8_t> write_answer(const AnswerHead& head);

void read(ros::MessageReader& reader, const GlanceQuestion& asked, Glance& glance);
/// layer: its region is what was asked for.
void read(ros::MessageReader& reader, RemoteLayer& layer);

}  // namespace diminish
