#include "remote/asked_images.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "core/tracing.h"
#include "diminish/camera_source.h"

namespace diminish {

AskedImages::AskedImages(std::string name, const NodeHead& head, const GlanceQuestion& question,
                         const RemoteSettings& settings, Send send)
    : name_(std::move(name)),
      head_(head),
      question_(question),
      settings_(settings),
      send_(std::move(send)) {
  head_.topic = NodeTopic::glance;
}

void AskedImages::ask() {
  send_(write_question(head_, question_));
}

bool AskedImages::take(NodeMessage<AnswerHead>& answer, double clock_offset_s) {
  if (answer.head.topic == NodeTopic::glance) {
    Glance made;
    if (answer.head.problem.empty()) {
      read(answer.rest, question_, made);
      made.color_stamp_s -= clock_offset_s;
      made.depth_stamp_s -= clock_offset_s;
    }
    return settle(glance_state_, answer.head.problem, made, glance_);
  }
  RemoteLayer made;
  {
    const std::lock_guard lock(mutex_);
    if (layer_state_ != State::asked) return false;
    made.region = layer_.region;
  }
  if (answer.head.problem.empty()) read(answer.rest, made);
  return settle(layer_state_, answer.head.problem, made, layer_);
}

template <class Value>
bool AskedImages::settle(State& state, const std::string& refusal, Value& made, Value& kept) {
  {
    const std::lock_guard lock(mutex_);
    if (state != State::asked) return false;
    refusal_ = refusal;
    state = refusal.empty() ? State::answered : State::refused;
    if (refusal.empty()) kept = std::move(made);
  }
  changed_.notify_all();
  return true;
}

double AskedImages::asked_for_layer_s() {
  const std::lock_guard lock(mutex_);
  return drawing_since_s_;
}

bool AskedImages::wait(State& state, double until_s, const char* what) {
  std::unique_lock lock(mutex_);
  const std::chrono::duration<double> left(until_s - monotonic_now_s());
  changed_.wait_for(lock, left, [&] { return state != State::asked; });
  if (state == State::answered) return true;
  problem_ = state == State::refused
                 ? fmt::format("{}: {}", name_, refusal_)
                 : fmt::format("{}: no {} within {:.2g} s", name_, what, settings_.wait_s);
  // What comes later is not looked at.
  state = State::refused;
  return false;
}

bool AskedImages::wait_for_glance(double until_s) {
  return wait(glance_state_, until_s, "answer");
}

std::int64_t AskedImages::question_ns() {
  const std::lock_guard lock(mutex_);
  return question_ns_;
}

void AskedImages::draw(const RemoteDrawing& drawing) {
  const std::int64_t begin_ns = tracing::thread_now_ns();
  {
    const std::lock_guard lock(mutex_);
    layer_state_ = State::asked;
    const Rect& region = drawing.region;
    layer_.region = region;
    drawing_since_s_ = monotonic_now_s();
  }
  NodeHead head = head_;
  head.topic = NodeTopic::layer;
  send_(write_question(head, drawing, settings_.coding));
  const std::lock_guard lock(mutex_);
  question_ns_ = tracing::thread_now_ns() - begin_ns;
}

const RemoteLayer* AskedImages::layer() {
  return wait(layer_state_, drawing_since_s_ + settings_.wait_s, "contribution") ? &layer_
                                                                                 : nullptr;
}

}  // namespace diminish
