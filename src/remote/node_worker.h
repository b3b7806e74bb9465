#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diminish/frame_set.h"
#include "remote/glance_maker.h"
#include "remote/layer_drawer.h"
#include "remote/node_messages.h"

namespace diminish {

/// What a node has answered.
struct NodeCounts {
  std::size_t glances = 0, layers = 0, failed = 0;
  std::size_t glance_bytes = 0, layer_bytes = 0, question_bytes = 0;
  double glance_ms = 0, draw_ms = 0, compress_ms = 0;  ///< all of them
  std::string problem;                                 ///< the last one
};

/// Answers the questions of users' machines about one RGB-D camera's images. Knows neither the
/// camera nor the wire. Used by one thread.
class NodeWorker {
 public:
  /// Two images of a moment.
  using Images = std::shared_ptr<const RgbdFrame>;
  /// Finds those nearest to a time, if both are within the tolerance; null if there are none.
  using Find = std::function<Images(double stamp_s, double tolerance_s)>;
  using Send = std::function<void(const std::vector<std::uint8_t>& answer)>;

  NodeWorker(Find find, Send send) : find_(std::move(find)), send_(std::move(send)) {}

  /// Answers a question at once, or keeps it until its images are there. A broken one is counted.
  void take(std::span<const std::uint8_t> question, double now_s);
  /// Answers the questions that wait, if their images are there or their time is up.
  void look_again(double now_s);
  /// Reads new images for the users who will ask for them.
  void prepare(const Images& images, double now_s);

  bool has_waiting() const;
  std::size_t users(double now_s) const;
  const NodeCounts& counts() const { return counts_; }

 private:
  struct Moment {
    std::uint64_t frame;
    Images images;
  };
  struct Waiting {
    NodeHead head;
    double received_s;
  };
  struct User {
    std::uint64_t id = 0;
    double last_s = 0;  ///< when it asked
    GlanceQuestion asked;
    /// What has been made for, once images were found to be of the camera's sizes: then nobody can
    /// have more memory taken than these need.
    GlanceQuestion made_for;
    std::unique_ptr<GlanceMaker> maker;
    std::unique_ptr<LayerDrawer> drawer;
    Glance glance;
    Images of_glance;  ///< what `glance` was made from; null: none
    std::optional<Waiting> waiting;
    std::deque<Moment> moments;  ///< of which a layer may be asked for
    LayerQuestion question;
    RemoteLayer layer;
  };

  User& user(std::uint64_t id, double now_s);
  void take_glance(NodeMessage<NodeHead>& message, double now_s);
  void take_layer(NodeMessage<NodeHead>& message, double now_s);
  /// False if the question has to wait.
  bool answer_glance(User& user, const Waiting& waiting, double now_s);
  static void make_tools(User& user);
  void make_glance(User& user, const Images& images);
  void send(const std::vector<std::uint8_t>& answer, std::size_t& bytes);
  void refuse(const AnswerHead& head, const std::string& problem);

  Find find_;
  Send send_;
  std::vector<std::unique_ptr<User>> users_;
  std::vector<std::uint8_t> answer_;  ///< a layer's
  NodeCounts counts_;
};

}  // namespace diminish
