#include "core/number_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "core/text.h"
#include "diminish/error.h"

namespace diminish {

void for_each_number_line(
    std::istream& stream, const std::filesystem::path& file,
    const std::function<void(const std::vector<double>& numbers, const FailLine& fail)>& visit) {
  std::string line;
  std::vector<double> numbers;
  for (int count = 1; std::getline(stream, line); ++count) {
    const FailLine fail = [&](const std::string& what) {
      throw Error(Error::input, fmt::format("{}:{}: {}", file.string(), count, what));
    };
    line.erase(std::find(line.begin(), line.end(), '#'), line.end());
    std::istringstream fields(line);
    numbers.clear();
    for (std::string text; fields >> text;) {
      const std::optional<double> value = parse_number(text);
      if (!value) fail("expected a finite number");
      numbers.push_back(*value);
    }
    if (!numbers.empty()) visit(numbers, fail);
  }
}

}  // namespace diminish
