#include "serve/picture_stream.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

std::string part(const std::string& frame, const std::string& body) {
  return "--picture\r\nContent-Type: image/jpeg\r\nContent-Length: " + std::to_string(body.size()) +
         "\r\nX-Frame: " + frame + "\r\nX-Stamp: 1.5\r\n\r\n" + body + "\r\n";
}

// Bodies that look like heads and ends, in pieces of any size.
TEST(PictureStream, FindsPicturesHoweverTheyAreCut) {
  const std::vector<std::string> bodies = {"one", "\r\n\r\nContent-Length: 3\r\n\r\n", "",
                                           std::string("\0\xFF\xD8\r\n", 5)};
  std::string text;
  for (std::size_t i = 0; i < bodies.size(); ++i) text += part(std::to_string(7 + i), bodies[i]);
  for (std::size_t piece = 1; piece <= text.size(); ++piece) {
    PictureStream stream;
    std::size_t found = 0;
    for (std::size_t at = 0; at < text.size(); at += piece) {
      stream.feed(text.data() + at, std::min(piece, text.size() - at));
      while (const auto picture = stream.next()) {
        ASSERT_LT(found, bodies.size());
        EXPECT_EQ(picture->frame, 7 + found);
        EXPECT_EQ(std::string(picture->jpeg.begin(), picture->jpeg.end()), bodies[found]);
        ++found;
      }
    }
    EXPECT_EQ(found, bodies.size()) << "in pieces of " << piece;
  }
}

TEST(PictureStream, WhatIsNoPictureIsAnErrorThatSaysWhatWasExpected) {
  const auto error_in = [](const std::string& text) {
    return error_of([&] {
      PictureStream stream;
      stream.feed(text.data(), text.size());
      stream.next();
    });
  };
  EXPECT_THAT(error_in("HTTP/1.1 404\r\n\r\n"), HasSubstr("expected 'Content-Length: '"));
  EXPECT_THAT(error_in(part("x", "one")), HasSubstr("expected 'X-Frame: ' and a number"));
}

}  // namespace
}  // namespace diminish
