#include "serve/access.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

TEST(Access, KnowsLoopback) {
  for (const char* address : {"127.0.0.1", "127.3.2.1", "localhost", "::1"}) {
    EXPECT_TRUE(is_loopback(address)) << address;
  }
  for (const char* address : {"0.0.0.0", "192.168.1.2", "::", "example.org", ""}) {
    EXPECT_FALSE(is_loopback(address)) << address;
  }
}

TEST(Access, KnowsAHostHeaderOfThisMachine) {
  for (const char* host : {"localhost", "localhost:8080", "127.0.0.1:80", "[::1]:8080", "[::1]"}) {
    EXPECT_TRUE(names_loopback(host)) << host;
  }
  for (const char* host :
       {"evil.example", "evil.example:8080", "", "[", "localhost.evil.example", "[fe80::1]:80"}) {
    EXPECT_FALSE(names_loopback(host)) << host;
  }
}

TEST(Access, TokensDifferAndAreCompared) {
  const std::string token = make_token();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_NE(token, make_token());
  EXPECT_TRUE(equals_secretly(token, std::string(token)));
  EXPECT_FALSE(equals_secretly(token.substr(1), token));
  EXPECT_FALSE(equals_secretly("", token));
  EXPECT_FALSE(equals_secretly(token, ""));
  std::string other = token;
  other.back() = other.back() == '0' ? '1' : '0';
  EXPECT_FALSE(equals_secretly(other, token));
}

}  // namespace
}  // namespace diminish
