#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <type_traits>

#include "core/text.h"
#include "diminish/color_corrector.h"
#include "diminish/inpainter.h"
#include "diminish/options.h"
#include "paths.h"

namespace diminish {
namespace {

std::string docs_page(const char* name) {
  return read_text_file(std::filesystem::path(testing::docs_dir()) / name, 1 << 20);
}

// The options are described once, in options.h; the docs must say the same.
TEST(CommandLineDocs, DescribeEveryOptionAsTheCodeDoes) {
  const std::string docs = docs_page("command-line.md");
  const Options defaults;
  for_each_option(defaults, [&](const OptionInfo& info, const auto& value) {
    std::string flag = info.name;
    std::replace(flag.begin(), flag.end(), '_', '-');
    std::string unit = info.unit;
    std::string text;
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, bool>) {
      text = value ? "on" : "off";
    } else {
      text = fmt::format("{}", value);
    }
    const std::string row = fmt::format("| `--{}` |{}| {} | {} |", flag,
                                        unit.empty() ? " " : " " + unit + " ", text, info.help);
    EXPECT_THAT(docs, ::testing::HasSubstr(row));
  });
}

TEST(CommandLineDocs, NameEveryMethod) {
  const std::string docs = docs_page("methods.md");
  for (const std::string& name : Registry<ColorCorrector>::names()) {
    EXPECT_THAT(docs, ::testing::HasSubstr("`" + name + "`"));
  }
  for (const std::string& name : Registry<Inpainter>::names()) {
    EXPECT_THAT(docs, ::testing::HasSubstr("`" + name + "`"));
  }
}

}  // namespace
}  // namespace diminish
