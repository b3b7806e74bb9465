#pragma once

#include <filesystem>

namespace diminish::dds {

/// What one participant needs of DDS Security 1.1's builtin plugins, in the layout of ROS 2's own
/// tools (SROS2): who it is, who says so, and what it may do.
struct KeyFiles {
  explicit KeyFiles(const std::filesystem::path& folder);

  std::filesystem::path identity_authority;     ///< identity_ca.cert.pem
  std::filesystem::path certificate;            ///< cert.pem
  std::filesystem::path private_key;            ///< key.pem
  std::filesystem::path permissions_authority;  ///< permissions_ca.cert.pem
  std::filesystem::path governance;             ///< governance.p7s
  std::filesystem::path permissions;            ///< permissions.p7s
};

/// Throws Error that names the first file that is missing or broken, out of date, not signed by its
/// authority, or not the others': DDS itself would not say which.
void check(const KeyFiles& files);

}  // namespace diminish::dds
