#pragma once

#include <string>

namespace diminish {

bool is_loopback(const std::string& address);

/// A token that cannot be guessed: 32 hexadecimal digits.
std::string make_token();

/// Whether two texts are equal, in a time that does not depend on where they differ.
bool equals_secretly(const std::string& a, const std::string& b);

/// Whether a request's Host header names this machine itself. False for a page of another site
/// whose name was pointed here (DNS rebinding).
bool names_loopback(const std::string& host_header);

}  // namespace diminish
