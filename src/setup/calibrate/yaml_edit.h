#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace diminish {

/// A step into a YAML document: the value of a key, or the list item with this `name`.
struct YamlStep {
  enum class Kind { key, named_item };

  Kind kind = Kind::key;
  std::string text;
};

inline YamlStep key(std::string text) {
  return {YamlStep::Kind::key, std::move(text)};
}
inline YamlStep named_item(std::string text) {
  return {YamlStep::Kind::named_item, std::move(text)};
}

/// Whether this place exists.
bool yaml_has(const std::string& yaml, const std::vector<YamlStep>& place,
              const std::filesystem::path& file);

/// Returns the document with `value` (one line: a word, a number, {...} or [...]) at this place,
/// which is created if missing. Everything else stays as it is, including comments. Throws Error
/// that names the file and says what to write by hand if that is impossible, for example where an
/// anchor also stands for other places. `file` is for messages.
std::string set_yaml(const std::string& yaml, const std::vector<YamlStep>& place,
                     const std::string& value, const std::filesystem::path& file);

}  // namespace diminish
