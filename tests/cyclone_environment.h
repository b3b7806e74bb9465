#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "paths.h"

namespace diminish {

/// Cyclone DDS's configuration for this process and its children: unicast on this machine only.
/// `domain` is what else its <Domain> holds.
class CycloneEnvironment {
 public:
  explicit CycloneEnvironment(const std::string& domain = "") {
    const std::string configuration =
        "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/>"
        "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery>"
        "<ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>31</MaxAutoParticipantIndex>"
        "<Peers><Peer address='127.0.0.1'/></Peers></Discovery>" +
        domain + "</Domain></CycloneDDS>";
    setenv("CYCLONEDDS_URI", configuration.c_str(), 1);
  }
  ~CycloneEnvironment() { unsetenv("CYCLONEDDS_URI"); }
  CycloneEnvironment(const CycloneEnvironment&) = delete;
  CycloneEnvironment& operator=(const CycloneEnvironment&) = delete;
};

inline std::string beside_the_program(const char* name) {
  return (std::filesystem::path(testing::program()).parent_path() / name).string();
}

}  // namespace diminish
