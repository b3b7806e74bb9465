#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace diminish {

/// A table with a header (RFC 4180), such as frames.csv: rows by column name.
using CsvRow = std::map<std::string, std::string>;

/// Throws Error that names the file. Rows with more or fewer cells than the header are errors.
std::vector<CsvRow> load_csv(const std::filesystem::path& file);
std::vector<CsvRow> parse_csv(const std::string& text, const std::filesystem::path& file);

}  // namespace diminish
