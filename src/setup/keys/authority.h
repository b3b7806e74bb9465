#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "dds/openssl.h"

namespace diminish {

/// For how long something is good.
struct Validity {
  std::chrono::system_clock::time_point from, until;
};

/// A certificate authority: who says who somebody is, or what they may do.
struct Authority {
  dds::Certificate certificate;
  dds::Key key;
};

/// A key of the curve P-256, which DDS Security names. Throws Error.
dds::Key make_key();
Authority make_authority(const std::string& name, const Validity& validity);
Authority read_authority(const std::filesystem::path& certificate,
                         const std::filesystem::path& key);
/// Of somebody by their common name. Throws Error.
dds::Certificate certify(const Authority& authority, const std::string& name, const dds::Key& key,
                         const Validity& validity);

std::string as_pem(const dds::Certificate& certificate);
std::string as_pem(const dds::Key& key);
/// The text, with its signature, as S/MIME. Throws Error.
std::string sign(const Authority& authority, const std::string& text);

}  // namespace diminish
