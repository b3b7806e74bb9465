#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace diminish {

struct YamlNode;

/// An item of a list, or a key of a map with its value.
struct YamlEntry {
  std::string key;  ///< empty in lists
  int line = 0;     ///< of the key, or of the item
  std::shared_ptr<const YamlNode> value;
};

/// A value in a YAML file.
struct YamlNode {
  enum class Kind { null, scalar, list, map };

  Kind kind = Kind::null;
  int line = 0;                    ///< where it begins; the file's first line is 1
  int height = 0;                  ///< levels of lists and maps below this one
  std::string text;                ///< of a scalar
  std::vector<YamlEntry> entries;  ///< of lists and maps, in the file's order
};

/// Reads a file with one YAML document. Throws Error with file and line on malformed YAML, repeated
/// keys and absurdly deep nesting.
std::shared_ptr<const YamlNode> parse_yaml(const std::string& yaml,
                                           const std::filesystem::path& file);

}  // namespace diminish
