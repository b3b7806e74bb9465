#include "serve/access.h"

#include <gtest/gtest.h>

namespace diminish {
namespace {

TEST(Access, KnowsLoopback) {
  for (const char* address : {"127.0.0.1", "127.3.2.1", "localhost", "::1", "0:0:0:0:0:0:0:1"}) {
    EXPECT_TRUE(is_loopback(address)) << address;
  }
  for (const char* address :
       {"0.0.0.0", "192.168.1.2", "::", "example.org", "", "127.0.0.1.evil.example",
        "127.evil.example", "127.0.0", "::1.evil.example", "127.0.0.1 "}) {
    EXPECT_FALSE(is_loopback(address)) << address;
  }
  EXPECT_FALSE(is_loopback(std::string("127.0.0.1\0.evil.example", 23)));
}

TEST(Access, KnowsAHostHeaderOfThisMachine) {
  for (const char* host : {"localhost", "localhost:8080", "127.0.0.1:80", "[::1]:8080", "[::1]"}) {
    EXPECT_TRUE(names_loopback(host)) << host;
  }
  for (const char* host : {"evil.example",
                           "evil.example:8080",
                           "",
                           "[",
                           "localhost.evil.example",
                           "[fe80::1]:80",
                           "127.0.0.1.evil.example",
                           "127.0.0.1.evil.example:8080",
                           "[::1].evil.example",
                           "[::1]evil.example:80",
                           "[127.0.0.1]",
                           "::1",
                           "localhost:",
                           "localhost:80:80",
                           "localhost:evil",
                           "localhost:123456",
                           "[::1]:",
                           "[::1]]",
                           "[[::1]]",
                           "[localhost]",
                           "[::1",
                           "::1]"}) {
    EXPECT_FALSE(names_loopback(host)) << host;
  }
  const std::string very_long(16 << 20, 'a');
  for (const std::string& host : {very_long, "[" + very_long + "]", "localhost:" + very_long,
                                  "[::1]:" + std::string(16 << 20, '1')}) {
    EXPECT_FALSE(names_loopback(host));
  }
}

TEST(Access, KnowsItsOwnPage) {
  EXPECT_TRUE(is_same_site("", "localhost:8080"));
  EXPECT_TRUE(is_same_site("http://localhost:8080", "localhost:8080"));
  EXPECT_TRUE(is_same_site("https://camera.example", "camera.example"));
  for (const char* origin : {"null", "http://localhost:8081", "http://localhost",
                             "http://localhost:8080.evil.example", "http://evil.example"}) {
    EXPECT_FALSE(is_same_site(origin, "localhost:8080")) << origin;
  }
}

TEST(Access, FindsACookie) {
  EXPECT_EQ(cookie_of("diminish=abc", "diminish"), "abc");
  EXPECT_EQ(cookie_of("a=1; diminish=a=b; c=2", "diminish"), "a=b");
  EXPECT_EQ(cookie_of("a=1;diminish=", "diminish"), "");
  for (const char* header :
       {"", ";", "; ;", "=", "diminish", "xdiminish=abc", "diminishx=abc", "a=diminish=abc"}) {
    EXPECT_EQ(cookie_of(header, "diminish"), "") << header;
  }
}

TEST(Access, TokensDifferAndAreCompared) {
  const std::string token = make_token();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_NE(token, make_token());
  EXPECT_TRUE(is_token(token));
  for (const char* text : {"a b", "a;b", "a,b", "a\"", "a&b", "\xc3\xa4", "a\n"}) {
    EXPECT_FALSE(is_token(text)) << text;
  }
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
