#include "diminish/config.h"

#include <fmt/format.h>

#include "expect_error.h"
#include "temporary_folder.h"

namespace diminish {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Config parse(const std::string& yaml) {
  return Config::parse(yaml, "folder/rig.yaml");
}

TEST(Config, ReadsEveryKindOfValue) {
  const Config config = parse(
      "name: rgbd0\n"
      "size: {width: 640, scale: 1e-3}\n"
      "rotation: [1, -2.5, +3]\n"
      "mesh: lamp.obj\n");
  EXPECT_EQ(config.at("name").text(), "rgbd0");
  EXPECT_EQ(config.at("name").choice({"rgbd0", "rgbd1"}), "rgbd0");
  EXPECT_EQ(config.at("size").at("width").integer(1, 640), 640);
  EXPECT_EQ(config.at("size").at("scale").positive_number(), 1e-3);
  EXPECT_EQ(config.at("rotation").vector3(), Eigen::Vector3d(1, -2.5, 3));
  EXPECT_EQ(config.at("mesh").path(), "folder/lamp.obj");
  EXPECT_EQ(config.file(), "folder/rig.yaml");
  EXPECT_THAT(config.keys(), ElementsAre("name", "size", "rotation", "mesh"));
  EXPECT_EQ(config.at("rotation").items().size(), 3U);
}

TEST(Config, EveryComplaintNamesFileLineKeyAndWhatIsThere) {
  const Config config = parse(
      "color:\n"
      "  width: -1\n"
      "items:\n"
      "  - {a: 1}\n"
      "  - {a: [1, nan]}\n");
  const Config width = config.at("color").at("width");
  const Config list = config.at("items").items()[1].at("a");
  const std::string where = "folder/rig.yaml:2: color.width: expected ";
  EXPECT_EQ(error_of([&] { width.integer(1, 9); }), where + "a whole number from 1 to 9, got '-1'");
  EXPECT_EQ(error_of([&] { width.positive_number(); }), where + "a number above 0, got '-1'");
  EXPECT_EQ(error_of([&] { width.choice({"a", "b"}); }), where + "one of a, b, got '-1'");
  EXPECT_EQ(error_of([&] { width.items(); }), where + "a list, got '-1'");
  EXPECT_EQ(error_of([&] { width.find("x"); }), where + "a map, got '-1'");
  EXPECT_EQ(error_of([&] { list.text(); }),
            "folder/rig.yaml:5: items[1].a: expected a text, got a list");
  EXPECT_EQ(error_of([&] { list.vector3(); }),
            "folder/rig.yaml:5: items[1].a: expected a list of 3 numbers, got 2");
  EXPECT_EQ(error_of([&] { list.numbers(2); }),
            "folder/rig.yaml:5: items[1].a[1]: expected a number, got 'nan'");
  EXPECT_EQ(error_of([&] { config.fail("expected more"); }), "folder/rig.yaml:1: expected more");
}

TEST(Config, RejectsWhatIsNotQuiteANumber) {
  for (const char* text :
       {"nan", ".nan", "inf", ".inf", "-.inf", "1e999", "0x10", "''", "~", "1m", "[1]", "{a: 1}"}) {
    const Config value = parse(std::string("a: ") + text).at("a");
    EXPECT_THAT(error_of([&] { value.number(); }), HasSubstr("a: expected a number, got")) << text;
    EXPECT_THAT(error_of([&] { value.integer(0, 9); }), HasSubstr("a: expected a whole number"));
  }
  EXPECT_ANY_THROW(parse("a: 1.0").at("a").integer(0, 9));
  EXPECT_ANY_THROW(parse("a: 99999999999").at("a").integer(0, 9));
  EXPECT_ANY_THROW(parse("a: 0").at("a").positive_number());
}

TEST(Config, MissingKeys) {
  const Config config = parse("# cameras\n\ncolor: {width: 1}\n");
  EXPECT_EQ(error_of([&] { config.at("color").at("camera_matrix"); }),
            "folder/rig.yaml:3: color: missing key 'camera_matrix'");
  const Config absent = config.find("pose").find("source");
  EXPECT_FALSE(absent.exists());
  EXPECT_EQ(error_of([&] { absent.text(); }),
            "folder/rig.yaml:3: pose.source: expected a text, got nothing");
  EXPECT_TRUE(config.find("color").exists());
}

TEST(Config, UnknownKeysAreErrorsThatNameTheKnownOnes) {
  const Config config = parse("color:\n  width: 1\n  heigth:\n    2\n");
  const auto message = error_of([&] { config.at("color").expect_keys({"width", "height"}); });
  EXPECT_EQ(message, "folder/rig.yaml:3: color.heigth: unknown key, expected one of width, height");
  EXPECT_NO_THROW(config.at("color").expect_keys({"width", "heigth", "depth"}));
}

TEST(Config, NothingIsThereByDefault) {
  const Config nothing;
  EXPECT_FALSE(nothing.exists());
  EXPECT_FALSE(nothing.find("source").exists());
  EXPECT_EQ(error_of([&] { nothing.at("source"); }), "missing key 'source'");
  EXPECT_EQ(error_of([&] { nothing.items(); }), "expected a list, got nothing");
}

TEST(Config, MalformedYamlIsOneLineWithFileAndLine) {
  for (const char* yaml :
       {"a: 1\nb: [1, 2\n", "a: 1\n\tb: 2\n", "a: 1\n  b: 2\n", "a: *unknown\n",
        "a: 1\n---\nb: 2\n", "a: 1\na: 2\n", "a: {b: 1, b: 2}\n", "? [a]\n: 1\n", "{}: 1\n",
        "a: &x [*x]\n", "%YAML 9.0\n---\na: 1\n", "a: \x04\nb: 1\n", "a: !<tag\n"}) {
    EXPECT_THAT(error_of([&] { parse(yaml); }),
                ::testing::MatchesRegex("folder/rig.yaml:[1-4]: .+"))
        << yaml;
  }
  EXPECT_EQ(error_of([] { parse("x: 0\na: 1\na: 2\n"); }),
            "folder/rig.yaml:3: key 'a' is repeated");
}

TEST(Config, EmptyFiles) {
  for (const char* yaml : {"", "\n\n", "# nothing\n", "~\n", "---\n"}) {
    EXPECT_EQ(error_of([&] { parse(yaml); }), "folder/rig.yaml: expected YAML, got an empty file");
  }
}

TEST(Config, DeepNestingIsAnErrorNotACrash) {
  EXPECT_THAT(error_of([] { parse("a: " + std::string(100000, '[')); }),
              HasSubstr("nested too deeply"));
  EXPECT_THAT(error_of([] { parse(std::string(100000, '{')); }), HasSubstr("nested too deeply"));
  // Not deep as it is written, but through its aliases.
  std::string chain = "a0: &a0 [1]\n";
  for (int i = 1; i < 20000; ++i) chain += fmt::format("a{0}: &a{0} [*a{1}]\n", i, i - 1);
  EXPECT_THAT(error_of([&] { parse(chain); }), HasSubstr("nested too deeply"));
}

TEST(Config, AliasesAreSharedNotCopied) {
  std::string bomb = "a0: &a0 [x, x, x, x, x, x]\n";
  for (int i = 1; i < 20; ++i) {
    bomb += fmt::format("a{0}: &a{0} [*a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}]\n", i, i - 1);
  }
  EXPECT_EQ(parse(bomb).at("a19").items().size(), 6U);  // 6^20 leaves
  const Config same = parse("a: &k {width: x}\nb: *k\n");
  EXPECT_THAT(error_of([&] { same.at("b").at("width").number(); }),
              StartsWith("folder/rig.yaml:1: b.width: "));
}

TEST(Config, LoadsFilesAndNamesThoseItCannot) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.yaml", "a: 1\r\nb: two\r\n");
  EXPECT_EQ(Config::load(file).at("b").text(), "two");
  EXPECT_EQ(Config::load(file).at("b").path(), folder.path() / "two");
  EXPECT_THAT(error_of([&] { Config::load(folder.path()); }), HasSubstr("got a folder"));
  EXPECT_THAT(error_of([&] { Config::load(folder.path() / "none.yaml"); }),
              HasSubstr("none.yaml: cannot be opened"));
  EXPECT_THAT(error_of([&] { Config::load(folder.write("e.yaml", "")); }),
              HasSubstr("e.yaml: expected YAML, got an empty file"));
}

}  // namespace
}  // namespace diminish
