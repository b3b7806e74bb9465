#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <memory>
#include <mutex>
#include <string>

#include "dds/dds.h"

namespace diminish::dds {

/// A participant, and its topics and types: each exists once, whoever uses it.
struct Node::Implementation {
  explicit Implementation(const Network& network);
  ~Implementation();

  /// The topic, made if there is none. Throws Error. What is returned is the participant's.
  eprosima::fastdds::dds::Topic* topic(const Topic& topic);

  /// Of Fast DDS's flow controllers, the one for what is sent; null: none.
  const char* flow_controller = nullptr;
  /// Why a topic may be refused where there are keys.
  std::string refusal;
  std::mutex mutex;
  eprosima::fastdds::dds::DomainParticipant* participant = nullptr;
};

/// Throws Error (device) that says what could not be made.
void expect_made(const void* made, const std::string& what);

}  // namespace diminish::dds
