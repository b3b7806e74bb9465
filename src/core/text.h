#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace diminish {

/// Parses a decimal number that fills all of `text`. Nothing for anything else, NaN and infinity.
std::optional<double> parse_number(std::string_view text);

/// `text` fit for a one-line message: control characters replaced, cut to a readable length.
std::string printable(std::string_view text);

/// The words of a line, separated by space, tab or carriage return.
std::vector<std::string_view> split_words(std::string_view line);

/// "a, b, c"
std::string join(const std::vector<std::string>& words, const char* separator = ", ");

/// Reads a whole text file. Throws Error that names the file if it cannot be read or is larger than
/// `max_bytes`.
std::string read_text_file(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace diminish
