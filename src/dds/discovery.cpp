#include <algorithm>
#include <string_view>
#include <tuple>

#include "dds/node.h"

namespace diminish::dds {
namespace {

constexpr std::size_t most_writers = 1000;
/// Before the names of ROS's topics.
constexpr std::string_view prefix = "rt/";

}  // namespace

void Discovery::on_writer(const Writer& writer) {
  if (!writer.topic.starts_with(prefix)) return;
  const std::lock_guard lock(mutex_);
  if (writer.is_gone) {
    writers_.erase(writer.guid);
  } else if (writers_.size() < most_writers) {
    writers_[writer.guid] = {writer.topic.substr(prefix.size() - 1), writer.type};
  }
}

std::vector<Topic> Discovery::topics() const {
  std::vector<Topic> topics;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [guid, topic] : writers_) topics.push_back(topic);
  }
  const auto key = [](const Topic& topic) { return std::tie(topic.name, topic.type); };
  std::sort(topics.begin(), topics.end(),
            [&](const Topic& a, const Topic& b) { return key(a) < key(b); });
  topics.erase(std::unique(topics.begin(), topics.end(),
                           [&](const Topic& a, const Topic& b) { return key(a) == key(b); }),
               topics.end());
  return topics;
}

std::vector<Topic> Node::topics_of_others() const {
  return implementation_->discovery.topics();
}

}  // namespace diminish::dds
