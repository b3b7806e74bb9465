#pragma once

#include <unistd.h>

#include <cstdlib>
#include <string>

namespace diminish {

/// A domain of this process's own, so that tests that run beside each other do not meet. Its
/// children are in it, too.
class Ros2Domain {
 public:
  Ros2Domain() { setenv("ROS_DOMAIN_ID", text().c_str(), 1); }
  ~Ros2Domain() { unsetenv("ROS_DOMAIN_ID"); }
  Ros2Domain(const Ros2Domain&) = delete;
  Ros2Domain& operator=(const Ros2Domain&) = delete;

  /// Those above 101 have ports that the kernel gives to others.
  int number() const { return 1 + getpid() % 100; }
  std::string text() const { return std::to_string(number()); }
};

}  // namespace diminish
