#include "setup/calibrate/yaml_edit.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>

#include "core/yaml_tree.h"
#include "diminish/error.h"

namespace diminish {
namespace {

using Place = std::vector<YamlStep>;
using Rest = Place::const_iterator;

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::size_t indentation(const std::string& line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

bool says_nothing(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first == std::string::npos || line[first] == '#';
}

std::string spaces(std::size_t count) {
  std::string text(count, ' ');
  return text;
}

/// The text to insert, as lines of a block that begins at this column.
void append_block(Rest step, Rest end, const std::string& value, std::size_t column,
                  std::vector<std::string>& lines) {
  if (step->kind == YamlStep::Kind::named_item) {
    lines.push_back(spaces(column) + "- name: " + step->text);
    if (std::next(step) != end) append_block(std::next(step), end, value, column + 2, lines);
    return;
  }
  const bool last = std::next(step) == end;
  lines.push_back(spaces(column) + step->text + (last ? ": " + value : ":"));
  if (!last) append_block(std::next(step), end, value, column + 2, lines);
}

/// The same, inside brackets.
std::string inline_text(Rest step, Rest end, const std::string& value) {
  const bool last = std::next(step) == end;
  if (step->kind == YamlStep::Kind::named_item) {
    return "{name: " + step->text + (last ? "" : ", " + inline_text(std::next(step), end, value)) +
           "}";
  }
  std::string inner = last ? value : inline_text(std::next(step), end, value);
  const bool is_map = !last && std::next(step)->kind == YamlStep::Kind::key;
  const bool is_list = !last && std::next(step)->kind == YamlStep::Kind::named_item;
  if (is_map) inner = "{" + inner + "}";
  if (is_list) inner = "[" + inner + "]";
  return step->text + ": " + inner;
}

class Editor {
 public:
  Editor(const std::string& text, const Place& place, const std::string& value)
      : place_(place), value_(value), lines_(split_lines(text)) {}

  std::string edit(const YAML::Node& root) {
    if (!root.IsDefined() || root.IsNull()) {
      append_block(place_.begin(), place_.end(), value_, 0, lines_);
    } else {
      walk(root, place_.begin());
    }
    std::string text;
    for (const std::string& line : lines_) text += line + "\n";
    return text;
  }

 private:
  static std::optional<std::pair<YAML::Node, YAML::Node>> find(const YAML::Node& node,
                                                               const YamlStep& step) {
    if (step.kind == YamlStep::Kind::key && node.IsMap()) {
      for (const auto& entry : node) {
        if (entry.first.Scalar() == step.text) return std::pair(entry.first, entry.second);
      }
    }
    if (step.kind == YamlStep::Kind::named_item && node.IsSequence()) {
      for (const auto& item : node) {
        if (item.IsMap() && item["name"] && item["name"].Scalar() == step.text) {
          return std::pair(YAML::Node(), YAML::Node(item));
        }
      }
    }
    return std::nullopt;
  }

  void walk(const YAML::Node& node, Rest step) {
    const auto found = find(node, *step);
    if (!found) return insert(node, step);
    if (std::next(step) != place_.end()) return walk(found->second, std::next(step));
    replace(found->first, found->second);
  }

  static bool is_flow(const YAML::Node& node) { return node.Style() == YAML::EmitterStyle::Flow; }

  /// Adds the missing steps from `step` on to a list or map.
  void insert(const YAML::Node& node, Rest step) {
    const YAML::Mark mark = node.Mark();
    if (node.IsMap() || node.IsSequence()) {
      if (is_flow(node)) {
        const auto [line, column] = closing_bracket(mark);
        const std::string separator = node.size() > 0 ? ", " : "";
        lines_[line].insert(column, separator + inline_text(step, place_.end(), value_));
        return;
      }
      const std::size_t end = block_end(mark, node.IsSequence());
      std::vector<std::string> added;
      append_block(step, place_.end(), value_, static_cast<std::size_t>(mark.column), added);
      lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(end), added.begin(), added.end());
    }
  }

  void replace(const YAML::Node& name, const YAML::Node& node) {
    const YAML::Mark mark = node.Mark();
    const auto line = static_cast<std::size_t>(mark.line);
    const auto column = static_cast<std::size_t>(mark.column);
    if (node.IsScalar()) {
      const std::string& text = lines_[line];
      const char quote = column < text.size() ? text[column] : ' ';
      const std::size_t length = quote == '"' || quote == '\''
                                     ? text.find(quote, column + 1) + 1 - column
                                     : node.Scalar().size();
      lines_[line].replace(column, length, value_);
      return;
    }
    if (node.IsMap() || node.IsSequence()) {
      if (is_flow(node)) {
        const auto [last_line, last_column] = closing_bracket(mark);
        const std::string tail = lines_[last_line].substr(last_column + 1);
        lines_[line] = lines_[line].substr(0, column) + value_ + tail;
        erase_lines(line + 1, last_line + 1);
        return;
      }
      // Keeps the key's line with its comment.
      const auto key_line = static_cast<std::size_t>(name.Mark().line);
      const std::size_t end = block_end(mark, node.IsSequence());
      std::string& text = lines_[key_line];
      const std::size_t colon =
          text.find(':', static_cast<std::size_t>(name.Mark().column) + name.Scalar().size());
      if (colon == std::string::npos) return;
      text.insert(colon + 1, " " + value_);
      erase_lines(key_line + 1, end);
    }
  }

  void erase_lines(std::size_t begin, std::size_t end) {
    lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(begin),
                 lines_.begin() + static_cast<std::ptrdiff_t>(end));
  }

  /// Where the bracket opened at `mark` closes.
  std::pair<std::size_t, std::size_t> closing_bracket(const YAML::Mark& mark) const {
    int depth = 0;
    char quote = 0;
    auto column = static_cast<std::size_t>(mark.column);
    for (auto line = static_cast<std::size_t>(mark.line); line < lines_.size(); ++line) {
      const std::string& text = lines_[line];
      for (; column < text.size(); ++column) {
        const char c = text[column];
        if (quote != 0) {
          if (c == quote) quote = 0;
          continue;
        }
        if (c == '#' && (column == 0 || text[column - 1] == ' ')) break;
        if (c == '"' || c == '\'') quote = c;
        if (c == '{' || c == '[') ++depth;
        if ((c == '}' || c == ']') && --depth == 0) return {line, column};
      }
      column = 0;
    }
    throw Error("a bracket is not closed");
  }

  /// The line after the last one of a block that begins at `mark`.
  std::size_t block_end(const YAML::Mark& mark, bool list) const {
    const auto column = static_cast<std::size_t>(mark.column);
    auto last = static_cast<std::size_t>(mark.line);
    for (std::size_t line = last + 1; line < lines_.size(); ++line) {
      if (says_nothing(lines_[line])) continue;
      const std::size_t indent = indentation(lines_[line]);
      const bool item = !list || lines_[line][indent] == '-';
      if (indent < column || (indent == column && !item)) break;
      last = line;
    }
    return last + 1;
  }

  const Place& place_;
  const std::string& value_;
  std::vector<std::string> lines_;
};

bool same(const YamlNode& a, const YamlNode& b) {
  if (a.kind != b.kind || a.text != b.text || a.entries.size() != b.entries.size()) return false;
  for (std::size_t i = 0; i < a.entries.size(); ++i) {
    if (a.entries[i].key != b.entries[i].key || !same(*a.entries[i].value, *b.entries[i].value)) {
      return false;
    }
  }
  return true;
}

const YamlNode* find_child(const YamlNode& node, const YamlStep& step) {
  for (const YamlEntry& entry : node.entries) {
    if (step.kind == YamlStep::Kind::key) {
      if (node.kind == YamlNode::Kind::map && entry.key == step.text) return entry.value.get();
    } else if (node.kind == YamlNode::Kind::list) {
      const YamlNode* name = find_child(*entry.value, key("name"));
      if (name && name->text == step.text) return entry.value.get();
    }
  }
  return nullptr;
}

/// Whether the documents differ at the place, and nowhere else.
bool same_but_for(const YamlNode* before, const YamlNode& after, Rest step, Rest end) {
  if (step == end) return true;
  const YamlNode* changed = find_child(after, *step);
  if (!changed) return false;
  const YamlNode* was = before ? find_child(*before, *step) : nullptr;
  for (const YamlEntry& entry : after.entries) {
    if (entry.value.get() == changed) continue;
    const YamlNode* other = nullptr;
    for (const YamlEntry& old : before ? before->entries : std::vector<YamlEntry>{}) {
      const bool counterpart =
          after.kind == YamlNode::Kind::map ? old.key == entry.key : same(*old.value, *entry.value);
      if (counterpart && same(*old.value, *entry.value)) other = old.value.get();
    }
    const bool own_name = !before && step != end && entry.key == "name";
    if (!other && !own_name) return false;
  }
  const std::size_t count = before ? before->entries.size() : after.entries.size() - 1;
  if (before && after.entries.size() != count + (was ? 0 : 1)) return false;
  return same_but_for(was, *changed, std::next(step), end);
}

YAML::Node load(const std::string& yaml, const std::filesystem::path& file) {
  try {
    return YAML::Load(yaml);
  } catch (const YAML::Exception& error) {
    throw Error(fmt::format("{}: malformed YAML: {}", file.string(), error.msg));
  }
}

bool is_blank(const std::string& yaml) {
  const auto lines = split_lines(yaml);
  return std::all_of(lines.begin(), lines.end(), says_nothing);
}

}  // namespace

bool yaml_has(const std::string& yaml, const Place& place, const std::filesystem::path& file) {
  if (is_blank(yaml)) return false;
  const auto root = parse_yaml(yaml, file);
  const YamlNode* node = root.get();
  for (const YamlStep& step : place) {
    node = find_child(*node, step);
    if (!node) return false;
  }
  return true;
}

std::string set_yaml(const std::string& yaml, const Place& place, const std::string& value,
                     const std::filesystem::path& file) {
  const bool blank = is_blank(yaml);
  const auto before = blank ? nullptr : parse_yaml(yaml, file);
  std::string names;
  for (const YamlStep& step : place) names += (names.empty() ? "" : ".") + step.text;
  const auto by_hand = [&] {
    return Error(
        fmt::format("{}: {} cannot be changed without changing other places; write by "
                    "hand: {}",
                    file.string(), names, value));
  };
  // Parses the result again: nothing else may have changed, whatever the layout.
  std::string edited;
  try {
    edited = Editor(yaml, place, value).edit(blank ? YAML::Node() : load(yaml, file));
    const auto after = parse_yaml(edited, file);
    if (!same_but_for(before.get(), *after, place.begin(), place.end())) throw by_hand();
    const YamlNode* node = after.get();
    for (const YamlStep& step : place) node = find_child(*node, step);
    if (!same(*node, *parse_yaml(value, file))) throw by_hand();
  } catch (const std::exception&) {
    throw by_hand();
  }
  return edited;
}

}  // namespace diminish
