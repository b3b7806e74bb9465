#include "score/csv_table.h"

#include "expect_error.h"

namespace diminish {
namespace {

using ::testing::HasSubstr;

TEST(CsvTable, ReadsQuotedCells) {
  const auto rows = parse_csv(
      "name,messages,n\n\"000001\",\"a \"\"word\"\", and\nmore\",3\r\n000002,,\n", "frames.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("name"), "000001");
  EXPECT_EQ(rows[0].at("messages"), "a \"word\", and\nmore");
  EXPECT_EQ(rows[0].at("n"), "3");
  EXPECT_EQ(rows[1].at("messages"), "");
}

TEST(CsvTable, ARowThatIsNotWholeIsAnError) {
  EXPECT_THAT(error_of([] { parse_csv("a,b\n1,2\n3\n", "frames.csv"); }),
              HasSubstr("frames.csv: row 2: expected 2 cells, got 1"));
  EXPECT_THAT(error_of([] { load_csv("/nowhere/frames.csv"); }), HasSubstr("/nowhere/frames.csv"));
}

}  // namespace
}  // namespace diminish
