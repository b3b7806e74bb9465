#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "diminish/remote_images.h"
#include "remote/node_messages.h"

namespace diminish {

/// How a node's contributions are to be sent, and how long they are waited for.
struct RemoteSettings {
  LayerCoding coding;
  double wait_s = 0.1;  ///< for each of a frame's two answers
};

/// A remote camera's images of one frame, on the user's machine. The pipeline's thread asks and
/// waits; the thread that receives calls `take`. Neither waits for the other longer than the
/// settings say.
class AskedImages : public RemoteImages {
 public:
  using Send = std::function<void(const std::vector<std::uint8_t>& question)>;

  /// name: the camera's, for messages.
  AskedImages(std::string name, const NodeHead& head, const GlanceQuestion& question,
              const RemoteSettings& settings, Send send);

  /// Sends the question for the glance. `take` may be called from then on.
  void ask();
  /// Waits for the glance, up to a time on the monotonic clock. False if it did not come:
  /// `problem` says why.
  bool wait_for_glance(double until_s);

  std::uint64_t frame() const { return head_.frame; }
  /// Takes an answer. clock_offset_s: the node's clock less this machine's. Throws Error for a
  /// broken one. False if it was late, or came twice; nothing changes then.
  bool take(NodeMessage<AnswerHead>& answer, double clock_offset_s);
  /// When a layer was asked for last, on the monotonic clock; 0: never.
  double asked_for_layer_s();
  /// For how long the pipeline's thread worked on that question.
  std::int64_t question_ns();

  const Glance& glance() const override { return glance_; }
  void draw(const RemoteDrawing& drawing) override;
  const RemoteLayer* layer() override;
  const std::string& problem() const override { return problem_; }

 private:
  enum class State { asked, answered, refused };

  template <class Value>
  bool settle(State& state, const std::string& refusal, Value& made, Value& kept);
  bool wait(State& state, double until_s, const char* what);

  std::string name_;
  NodeHead head_;
  GlanceQuestion question_;
  RemoteSettings settings_;
  Send send_;

  std::mutex mutex_;  ///< guards all below, until it is answered
  std::condition_variable changed_;
  State glance_state_ = State::asked, layer_state_ = State::refused;
  std::string refusal_;
  Glance glance_;
  RemoteLayer layer_;
  double drawing_since_s_ = 0;
  std::int64_t question_ns_ = 0;
  std::string problem_;  ///< the pipeline's thread's
};

}  // namespace diminish
