#include "core/text.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <system_error>

#include "diminish/error.h"

namespace diminish {

std::optional<double> parse_number(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number)) return std::nullopt;
  return number;
}

std::string printable(std::string_view text) {
  constexpr std::size_t longest = 80;
  std::string result(text.substr(0, longest));
  for (char& character : result) {
    const auto code = static_cast<unsigned char>(character);
    if (code < 0x20 || code == 0x7f) character = '?';
  }
  if (text.size() > longest) result += "...";
  return result;
}

std::vector<std::string_view> split_words(std::string_view line) {
  constexpr const char* separators = " \t\r";
  std::vector<std::string_view> words;
  std::size_t begin = line.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
  return words;
}

std::string join(const std::vector<std::string>& words, const char* separator) {
  return fmt::format("{}", fmt::join(words, separator));
}

std::string read_text_file(const std::filesystem::path& file, std::size_t max_bytes) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    throw Error(Error::io, file.string() + ": expected a file, got a folder");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw Error(Error::io,
                file.string() + ": cannot be opened: " + std::generic_category().message(errno));
  }
  // In blocks, so that endless files (devices, pipes) end here too.
  std::string text;
  std::array<char, 1 << 16> piece;
  while (stream.read(piece.data(), piece.size()), stream.gcount() > 0) {
    text.append(piece.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > max_bytes) {
      throw Error(Error::io,
                  fmt::format("{}: expected at most {} bytes", file.string(), max_bytes));
    }
  }
  if (stream.bad()) throw Error(Error::io, file.string() + ": cannot be read");
  return text;
}

}  // namespace diminish
