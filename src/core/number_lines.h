#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <istream>
#include <string>
#include <vector>

namespace diminish {

/// Fails a line of a text file: throws Error with file and line.
using FailLine = std::function<void(const std::string& what)>;

/// Calls visit(numbers, fail) for each line that has numbers: finite, separated by spaces. '#'
/// starts a comment. Throws Error with file and line on anything else.
void for_each_number_line(
    std::istream& stream, const std::filesystem::path& file,
    const std::function<void(const std::vector<double>& numbers, const FailLine& fail)>& visit);

}  // namespace diminish
