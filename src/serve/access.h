#pragma once

#include <string>

namespace diminish {

bool is_loopback(const std::string& address);

/// A token that nobody can guess: 32 hexadecimal digits.
std::string make_token();

/// Whether two texts are equal, in a time that does not tell where they differ.
bool equals_secretly(const std::string& a, const std::string& b);

/// Whether a request's Host header names this machine itself. A page of another site that had its
/// name point here (DNS rebinding) does not.
bool names_loopback(const std::string& host_header);

}  // namespace diminish
