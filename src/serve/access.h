#pragma once

#include <string>

namespace diminish {

/// "localhost", or an address of the loopback network. A name that only begins like one is not.
bool is_loopback(const std::string& address);

/// A token that cannot be guessed: 32 hexadecimal digits.
std::string make_token();

/// Whether a token can stand in a header, an address and a cookie as it is. An empty one can.
bool is_token(const std::string& text);

/// Whether two texts are equal, in a time that does not depend on where they differ.
bool equals_secretly(const std::string& a, const std::string& b);

/// Whether a request's Host header names this machine itself. False for a page of another site
/// whose name was pointed here (DNS rebinding).
bool names_loopback(const std::string& host_header);

/// Whether a request comes from the program's own page, or from no page at all, by its headers
/// Origin and Host.
bool is_same_site(const std::string& origin_header, const std::string& host_header);

/// The value of a cookie in a request's Cookie header; empty if it is not there.
std::string cookie_of(const std::string& cookie_header, const std::string& name);

}  // namespace diminish
