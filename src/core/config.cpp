#include "diminish/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/text.h"
#include "core/yaml_tree.h"
#include "diminish/error.h"

namespace diminish {
namespace {

constexpr std::size_t max_file_bytes = 4 << 20;

}  // namespace

struct Config::Node {
  std::filesystem::path file;
  std::string key_path;  ///< "occluders[0].marker"; empty for the whole file
  int line = 0;
  std::shared_ptr<const YamlNode> yaml;  ///< null where there is nothing

  [[noreturn]] void fail(const std::string& message) const {
    std::string place = file.string();
    if (line > 0) place += fmt::format(":{}", line);
    if (!place.empty()) place += ": ";
    if (!key_path.empty()) place += key_path + ": ";
    throw Error(place + message);
  }

  /// What was found, for messages.
  std::string got() const {
    switch (yaml ? yaml->kind : YamlNode::Kind::null) {
      case YamlNode::Kind::scalar:
        return fmt::format("'{}'", printable(yaml->text));
      case YamlNode::Kind::list:
        return "a list";
      case YamlNode::Kind::map:
        return "a map";
      case YamlNode::Kind::null:
        break;
    }
    return "nothing";
  }

  const YamlNode& expect(YamlNode::Kind kind, const std::string& what) const {
    if (!yaml || yaml->kind != kind) fail("expected " + what + ", got " + got());
    return *yaml;
  }

  Config child(const std::string& step, const YamlEntry* entry) const {
    const bool dot = !key_path.empty() && !step.starts_with('[');
    auto node =
        std::make_shared<Node>(Node{file, key_path + (dot ? "." : "") + printable(step), line, {}});
    if (entry != nullptr) {
      node->line = entry->value->line;
      node->yaml = entry->value;
    }
    return Config(std::move(node));
  }
};

Config::Config() : node_(std::make_shared<const Node>()) {}
Config::Config(std::shared_ptr<const Node> node) : node_(std::move(node)) {}
Config::~Config() = default;
Config::Config(const Config&) = default;
Config& Config::operator=(const Config&) = default;
Config::Config(Config&&) noexcept = default;
Config& Config::operator=(Config&&) noexcept = default;

Config Config::load(const std::filesystem::path& file) {
  return parse(read_text_file(file, max_file_bytes), file);
}

Config Config::parse(const std::string& yaml, const std::filesystem::path& file) {
  auto root = parse_yaml(yaml, file);
  const int line = root->line;
  return Config(std::make_shared<const Node>(Node{file, "", line, std::move(root)}));
}

bool Config::exists() const {
  return node_->yaml != nullptr;
}

const std::filesystem::path& Config::file() const {
  return node_->file;
}

void Config::expect_keys(std::initializer_list<const char*> known) const {
  expect_keys(std::vector<std::string>(known.begin(), known.end()));
}

void Config::expect_keys(const std::vector<std::string>& known) const {
  for (const YamlEntry& entry : node_->expect(YamlNode::Kind::map, "a map").entries) {
    if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
    Node place = *node_->child(entry.key, &entry).node_;
    place.line = entry.line;
    place.fail("unknown key, expected one of " + join(known));
  }
}

Config Config::at(const std::string& key) const {
  Config value = find(key);
  if (!value.exists()) fail("missing key '" + key + "'");
  return value;
}

Config Config::find(const std::string& key) const {
  if (!exists()) return node_->child(key, nullptr);
  const auto& entries = node_->expect(YamlNode::Kind::map, "a map").entries;
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const YamlEntry& entry) { return entry.key == key; });
  return node_->child(key, found == entries.end() ? nullptr : &*found);
}

std::vector<Config> Config::items() const {
  std::vector<Config> result;
  for (const YamlEntry& entry : node_->expect(YamlNode::Kind::list, "a list").entries) {
    result.push_back(node_->child(fmt::format("[{}]", result.size()), &entry));
  }
  return result;
}

std::vector<std::string> Config::keys() const {
  std::vector<std::string> result;
  for (const YamlEntry& entry : node_->expect(YamlNode::Kind::map, "a map").entries) {
    result.push_back(entry.key);
  }
  return result;
}

std::string Config::text() const {
  return node_->expect(YamlNode::Kind::scalar, "a text").text;
}

std::string Config::choice(std::initializer_list<const char*> choices) const {
  const std::vector<std::string> known(choices.begin(), choices.end());
  const std::string what = "one of " + join(known);
  const std::string& given = node_->expect(YamlNode::Kind::scalar, what).text;
  if (std::find(known.begin(), known.end(), given) == known.end()) {
    fail("expected " + what + ", got " + node_->got());
  }
  return given;
}

int Config::integer(int min, int max) const {
  const std::string what = fmt::format("a whole number from {} to {}", min, max);
  const std::string& given = node_->expect(YamlNode::Kind::scalar, what).text;
  int number = 0;
  const char* end = given.data() + given.size();
  const auto [stop, error] = std::from_chars(given.data(), end, number);
  if (error != std::errc() || stop != end || number < min || number > max) {
    fail("expected " + what + ", got " + node_->got());
  }
  return number;
}

double Config::number() const {
  const auto number = parse_number(node_->expect(YamlNode::Kind::scalar, "a number").text);
  if (!number) fail("expected a number, got " + node_->got());
  return *number;
}

double Config::positive_number() const {
  const std::string what = "a number above 0";
  const auto number = parse_number(node_->expect(YamlNode::Kind::scalar, what).text);
  if (!number || *number <= 0) fail("expected " + what + ", got " + node_->got());
  return *number;
}

std::vector<double> Config::numbers(std::size_t count) const {
  const std::string what = fmt::format("a list of {} numbers", count);
  const auto& entries = node_->expect(YamlNode::Kind::list, what).entries;
  if (entries.size() != count) fail(fmt::format("expected {}, got {}", what, entries.size()));
  std::vector<double> result;
  for (const Config& item : items()) result.push_back(item.number());
  return result;
}

Eigen::Vector3d Config::vector3() const {
  const std::vector<double> values = numbers(3);
  return {values[0], values[1], values[2]};
}

std::filesystem::path Config::path() const {
  const std::string& given = node_->expect(YamlNode::Kind::scalar, "a path").text;
  if (given.empty() || given.find('\0') != std::string::npos) {
    fail("expected a path, got " + node_->got());
  }
  return node_->file.parent_path() / given;
}

void Config::fail(const std::string& message) const {
  node_->fail(message);
}

}  // namespace diminish
