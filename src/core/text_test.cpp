#include "core/text.h"

#include "expect_error.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Text, ParsesNumbersAndNothingElse) {
  EXPECT_EQ(parse_number("-1.5e3"), -1500);
  EXPECT_EQ(parse_number("+7"), 7);
  EXPECT_EQ(parse_number(".5"), 0.5);
  for (const char* text : {"", "+", "+-1", "1.0.0", "1 ", " 1", "nan", "inf", "-inf", ".inf",
                           "1e999", "0x10", "1,5", "one"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

TEST(Text, SplitsAtAnyWhiteSpace) {
  EXPECT_THAT(split_words("  a \tbc\r"), ElementsAre("a", "bc"));
  EXPECT_THAT(split_words(" \t\r"), IsEmpty());
}

TEST(Text, PrintableIsOneShortLine) {
  EXPECT_EQ(printable("a\nb\x1b"), "a?b?");
  EXPECT_EQ(printable(std::string(1000, 'x')), std::string(80, 'x') + "...");
}

TEST(Text, ReadsWholeFilesUpToALimit) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.txt", "12345");
  EXPECT_EQ(read_text_file(file, 5), "12345");
  EXPECT_THAT(error_of([&] { read_text_file(file, 4); }), HasSubstr("at most 4 bytes"));
  EXPECT_THAT(error_of([&] { read_text_file(folder.path(), 4); }), HasSubstr("got a folder"));
  EXPECT_EQ(error_of([&] { read_text_file(folder.path() / "none", 4); }),
            (folder.path() / "none").string() + ": cannot be opened: No such file or directory");
}

}  // namespace
}  // namespace diminish
