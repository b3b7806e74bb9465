#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace diminish {

// DDS Security 1.1, 9.4.1: what all participants must do, and what one of them may do. XML.

/// Nobody without keys; all that is said is encrypted and authenticated, in every domain.
std::string governance_xml();

/// What a participant may do, by ROS's names of topics ("/rgbd0/*").
struct Permissions {
  std::string subject;  ///< "/camera_host", its certificate's common name
  std::vector<std::string> publish, subscribe;
  std::chrono::system_clock::time_point from, until;
};
std::string permissions_xml(const Permissions& permissions);

}  // namespace diminish
