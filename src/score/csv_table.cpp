#include "score/csv_table.h"

#include <fmt/format.h>

#include "core/text.h"
#include "diminish/error.h"

namespace diminish {
namespace {

/// The cells of the line at `position`, which moves past it.
std::vector<std::string> parse_line(const std::string& text, std::size_t& position) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (; position < text.size(); ++position) {
    const char c = text[position];
    if (quoted && c == '"' && position + 1 < text.size() && text[position + 1] == '"') {
      cells.back() += c;
      ++position;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == ',') {
      cells.emplace_back();
    } else if (!quoted && c == '\n') {
      ++position;
      break;
    } else if (quoted || c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

}  // namespace

std::vector<CsvRow> load_csv(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = std::size_t{1} << 30;
  return parse_csv(read_text_file(file, max_bytes), file);
}

std::vector<CsvRow> parse_csv(const std::string& text, const std::filesystem::path& file) {
  std::size_t position = 0;
  const std::vector<std::string> header = parse_line(text, position);
  std::vector<CsvRow> rows;
  while (position < text.size()) {
    const std::vector<std::string> cells = parse_line(text, position);
    if (cells.size() != header.size()) {
      throw Error(Error::input, fmt::format("{}: row {}: expected {} cells, got {}", file.string(),
                                            rows.size() + 1, header.size(), cells.size()));
    }
    CsvRow& row = rows.emplace_back();
    for (std::size_t i = 0; i < cells.size(); ++i) row[header[i]] = cells[i];
  }
  return rows;
}

}  // namespace diminish
