#include <gmock/gmock.h>

#include <filesystem>
#include <regex>

#include "core/text.h"
#include "paths.h"
#include "run_program.h"

namespace diminish {
namespace {

// The docs describe every flag of the set-up commands.
TEST(CommandLineDocs, DescribeTheFlagsOfSettingUp) {
  const std::string docs =
      read_text_file(std::filesystem::path(testing::docs_dir()) / "set-up-commands.md", 1 << 20);
  const std::vector<std::vector<std::string>> commands = {{"markers"},
                                                          {"calibrate", "intrinsics"},
                                                          {"calibrate", "factory"},
                                                          {"calibrate", "rig"},
                                                          {"check"}};
  for (std::vector<std::string> command : commands) {
    std::string title = "\n## " + command[0];
    if (command.size() > 1) title += " " + command[1];
    const std::size_t begin = docs.find(title + "\n");
    ASSERT_NE(begin, std::string::npos) << title;
    const std::string section = docs.substr(begin, docs.find("\n## ", begin + 1) - begin);
    command.emplace_back("--help");
    const std::string help = Program::run(command).out;
    const std::regex flag("\n *(--[a-z-]+)");
    std::size_t count = 0;
    for (std::sregex_iterator i(help.begin(), help.end(), flag), end; i != end; ++i) {
      EXPECT_THAT(section, ::testing::HasSubstr("`" + i->str(1))) << title;
      ++count;
    }
    EXPECT_GE(count, 2U) << help;
  }
}

TEST(SettingUpDocs, NameEveryFinding) {
  const std::filesystem::path docs(testing::docs_dir());
  const std::string text = read_text_file(docs / "checking.md", 1 << 20);
  const std::regex finding("setup\\.find\\([^;\"]*\"([a-z-]+)\"");
  std::size_t count = 0;
  for (const auto& file :
       std::filesystem::recursive_directory_iterator(docs / ".." / "src" / "setup")) {
    if (file.path().extension() != ".cpp") continue;
    const std::string code = read_text_file(file.path(), 1 << 20);
    for (std::sregex_iterator i(code.begin(), code.end(), finding), end; i != end; ++i) {
      EXPECT_THAT(text, ::testing::HasSubstr("`" + i->str(1) + "`")) << file.path();
      ++count;
    }
  }
  EXPECT_GE(count, 12U);
}

}  // namespace
}  // namespace diminish
