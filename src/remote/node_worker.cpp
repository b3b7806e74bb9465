#include "remote/node_worker.h"

#include <fmt/format.h>

#include <algorithm>

#include "diminish/camera_source.h"
#include "diminish/error.h"

namespace diminish {
namespace {

constexpr std::size_t most_users = 8;
constexpr std::size_t most_moments = 8;
/// Who has not asked for this long is not prepared for.
constexpr double patience_s = 1;

double since_ms(double start_s) {
  return 1e3 * (monotonic_now_s() - start_s);
}

AnswerHead answer_to(const NodeHead& head, double asked_s, double received_s) {
  AnswerHead answer;
  static_cast<NodeHead&>(answer) = head;
  answer.asked_s = asked_s;
  answer.received_s = received_s;
  return answer;
}

bool is_same(const RgbdCamera& a, const RgbdCamera& b) {
  return a.color == b.color && a.depth == b.depth && a.depth_unit_m == b.depth_unit_m &&
         a.color_from_depth.rotation == b.color_from_depth.rotation &&
         a.color_from_depth.translation == b.color_from_depth.translation;
}

/// Why images cannot be those of the camera in the user's rig; empty if they can.
std::string wrong_size(const RgbdFrame& images, const RgbdCamera& camera) {
  const auto differs = [](const auto& image, const Intrinsics& lens, const char* what) {
    return image.bounds() == lens.bounds()
               ? std::string()
               : fmt::format("its {} images have {}x{} pixels, the user's rig.yaml says {}x{}",
                             what, image.width(), image.height(), lens.width, lens.height);
  };
  const std::string color = differs(images.color, camera.color, "colour");
  return color.empty() ? differs(images.depth, camera.depth, "depth") : color;
}

}  // namespace

NodeWorker::User& NodeWorker::user(std::uint64_t id, double now_s) {
  auto found =
      std::find_if(users_.begin(), users_.end(), [&](const auto& one) { return one->id == id; });
  if (found == users_.end()) {
    if (users_.size() >= most_users) {
      users_.erase(std::min_element(users_.begin(), users_.end(), [](const auto& a, const auto& b) {
        return a->last_s < b->last_s;
      }));
    }
    users_.push_back(std::make_unique<User>());
    found = users_.end() - 1;
    (*found)->id = id;
  }
  (*found)->last_s = now_s;
  return **found;
}

std::size_t NodeWorker::users(double now_s) const {
  return static_cast<std::size_t>(
      std::count_if(users_.begin(), users_.end(),
                    [&](const auto& user) { return now_s < user->last_s + patience_s; }));
}

bool NodeWorker::has_waiting() const {
  return std::any_of(users_.begin(), users_.end(),
                     [](const auto& user) { return user->waiting.has_value(); });
}

void NodeWorker::take(std::span<const std::uint8_t> question, double now_s) {
  counts_.question_bytes += question.size();
  try {
    auto message = open_question(question);
    if (message.head.topic == NodeTopic::glance) {
      take_glance(message, now_s);
    } else {
      take_layer(message, now_s);
    }
  } catch (const Error& error) {
    ++counts_.failed;
    counts_.problem = error.what();
  }
}

void NodeWorker::take_glance(NodeMessage<NodeHead>& message, double now_s) {
  GlanceQuestion asked;
  read(message.rest, asked);
  User& from = user(message.head.user, now_s);
  from.asked = std::move(asked);
  // One that still waits is of an earlier frame.
  from.waiting = Waiting{message.head, now_s};
  if (answer_glance(from, *from.waiting, now_s)) from.waiting.reset();
}

void NodeWorker::make_tools(User& user) {
  const GlanceQuestion& asked = user.asked;
  const GlanceQuestion& made_for = user.made_for;
  const bool has_same_camera = user.maker && is_same(asked.camera, made_for.camera);
  if (!has_same_camera || !(asked.wishes == made_for.wishes)) {
    user.maker = std::make_unique<GlanceMaker>(asked.camera, asked.wishes);
    user.of_glance = nullptr;
  }
  if (!has_same_camera || !(asked.user == made_for.user)) {
    user.drawer = std::make_unique<LayerDrawer>(asked.camera, asked.user);
    user.moments.clear();
  }
  user.made_for = asked;
}

void NodeWorker::look_again(double now_s) {
  for (const auto& user : users_) {
    if (user->waiting && answer_glance(*user, *user->waiting, now_s)) user->waiting.reset();
  }
}

void NodeWorker::prepare(const Images& images, double now_s) {
  for (const auto& user : users_) {
    if (now_s > user->last_s + patience_s || !user->maker) continue;
    if (wrong_size(*images, user->made_for.camera).empty()) make_glance(*user, images);
  }
}

void NodeWorker::make_glance(User& user, const Images& images) {
  if (user.of_glance == images) return;
  const double start_s = monotonic_now_s();
  user.maker->make(*images, user.glance);
  user.of_glance = images;
  counts_.glance_ms += since_ms(start_s);
}

bool NodeWorker::answer_glance(User& user, const Waiting& waiting, double now_s) {
  const GlanceQuestion& asked = user.asked;
  const Images images = find_(asked.stamp_s, asked.tolerance_s);
  if (!images && now_s < waiting.received_s + asked.patience_s) return false;
  const auto head = [&] { return answer_to(waiting.head, asked.asked_s, waiting.received_s); };
  if (!images) {
    refuse(head(), fmt::format("no images within {:.2g} s", asked.tolerance_s));
    return true;
  }
  if (const std::string problem = wrong_size(*images, asked.camera); !problem.empty()) {
    refuse(head(), problem);
    return true;
  }
  make_tools(user);
  make_glance(user, images);
  user.moments.push_back({waiting.head.frame, images});
  if (user.moments.size() > most_moments) user.moments.pop_front();
  ++counts_.glances;
  send(write_answer(head(), user.glance, asked), counts_.glance_bytes);
  return true;
}

void NodeWorker::take_layer(NodeMessage<NodeHead>& message, double now_s) {
  const auto known = std::find_if(users_.begin(), users_.end(),
                                  [&](const auto& one) { return one->id == message.head.user; });
  if (known == users_.end()) return;  // it will ask for a glance again
  User& from = user(message.head.user, now_s);
  const auto moment = std::find_if(from.moments.begin(), from.moments.end(), [&](const auto& one) {
    return one.frame == message.head.frame;
  });
  if (moment == from.moments.end()) {
    refuse(answer_to(message.head, from.asked.asked_s, now_s), "its images are gone");
    return;
  }
  read(message.rest, from.made_for, from.question);
  const double start_s = monotonic_now_s();
  from.drawer->draw(*moment->images, from.question.drawing(), from.layer);
  const double drawn_s = monotonic_now_s();
  counts_.draw_ms += 1e3 * (drawn_s - start_s);
  write_answer(answer_to(message.head, from.asked.asked_s, now_s), from.layer, from.question.coding,
               answer_);
  counts_.compress_ms += since_ms(drawn_s);
  ++counts_.layers;
  send(answer_, counts_.layer_bytes);
}

void NodeWorker::send(const std::vector<std::uint8_t>& answer, std::size_t& bytes) {
  bytes += answer.size();
  send_(answer);
}

void NodeWorker::refuse(const AnswerHead& head, const std::string& problem) {
  AnswerHead answer = head;
  answer.problem = problem;
  send_(write_answer(answer));
}

}  // namespace diminish
