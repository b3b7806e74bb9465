#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace diminish {

/// A step into a YAML document: the value of a key, or the item of a list that has this `name`.
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

/// Whether there is something at this place.
bool yaml_has(const std::string& yaml, const std::vector<YamlStep>& place,
              const std::filesystem::path& file);

/// The document with `value` (one line: a word, a number, {...} or [...]) at this place, which is
/// made if it is not there. Everything else stays as it is, comments included. Throws Error that
/// names the file and says what to write by hand if that is not possible: where anchors stand for
/// other places, too. `file` is for messages.
std::string set_yaml(const std::string& yaml, const std::vector<YamlStep>& place,
                     const std::string& value, const std::filesystem::path& file);

}  // namespace diminish
