#include "core/yaml_tree.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <unordered_set>

#include "core/text.h"
#include "diminish/error.h"

namespace diminish {
namespace {

constexpr int max_height = 32;

[[noreturn]] void fail(const std::filesystem::path& file, int line, const std::string& message) {
  throw Error(fmt::format("{}:{}: {}", file.string(), line, message));
}

/// Builds the tree from the parser's events. Aliases share their anchor's node. The readers look
/// only for what they know, so a tree of shared nodes cannot blow up.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::filesystem::path& file) : file_(file) {}

  std::shared_ptr<const YamlNode> root() const { return root_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (root_) fail(file_, mark.line + 1, "expected one YAML document, got a second one");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(make(YamlNode::Kind::null, mark), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string& text) override {
    auto node = make(YamlNode::Kind::scalar, mark);
    node->text = text;
    add(std::move(node), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) fail(file_, mark.line + 1, "an alias inside its own anchor");
    add(found->second, YAML::NullAnchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::list, mark, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(YamlNode::Kind::map, mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  /// A list or map that is not finished yet.
  struct Open {
    std::shared_ptr<YamlNode> node;
    YAML::anchor_t anchor;
    std::optional<YamlEntry> pending;  ///< a key without its value yet
    std::unordered_set<std::string> keys;
  };

  static std::shared_ptr<YamlNode> make(YamlNode::Kind kind, const YAML::Mark& mark) {
    auto node = std::make_shared<YamlNode>();
    node->kind = kind;
    node->line = mark.line + 1;
    return node;
  }

  void open(YamlNode::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (open_.size() >= max_height) fail(file_, mark.line + 1, "lists and maps nested too deeply");
    open_.push_back({make(kind, mark), anchor, std::nullopt, {}});
  }

  void close() {
    const Open closed = std::move(open_.back());
    open_.pop_back();
    add(closed.node, closed.anchor);
  }

  void add(std::shared_ptr<const YamlNode> node, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor) anchors_[anchor] = node;
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node->kind == YamlNode::Kind::map && !parent.pending) {
      begin_entry(parent, *node);
      return;
    }
    // Aliases can make a tree deeper than its text.
    parent.node->height = std::max(parent.node->height, node->height + 1);
    if (parent.node->height > max_height) {
      fail(file_, node->line, "lists and maps nested too deeply");
    }
    YamlEntry entry = std::move(parent.pending).value_or(YamlEntry{"", node->line, nullptr});
    parent.pending.reset();
    entry.value = std::move(node);
    parent.node->entries.push_back(std::move(entry));
  }

  void begin_entry(Open& map, const YamlNode& key) {
    if (key.kind != YamlNode::Kind::scalar) fail(file_, key.line, "expected a word as the key");
    if (!map.keys.insert(key.text).second) {
      fail(file_, key.line, fmt::format("key '{}' is repeated", printable(key.text)));
    }
    map.pending = YamlEntry{key.text, key.line, nullptr};
  }

  const std::filesystem::path& file_;
  std::shared_ptr<const YamlNode> root_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, std::shared_ptr<const YamlNode>> anchors_;
};

/// The parser takes some control characters for the end of the file and would ignore the rest.
void expect_text(const std::string& yaml, const std::filesystem::path& file) {
  int line = 1;
  for (const char character : yaml) {
    if (character == '\n') ++line;
    const bool white = character == '\n' || character == '\r' || character == '\t';
    if (static_cast<unsigned char>(character) < 0x20 && !white) {
      fail(file, line, "expected UTF-8 text, got a control character");
    }
  }
}

}  // namespace

std::shared_ptr<const YamlNode> parse_yaml(const std::string& yaml,
                                           const std::filesystem::path& file) {
  expect_text(yaml, file);
  std::istringstream stream(yaml);
  TreeBuilder builder(file);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    fail(file, std::max(error.mark.line, 0) + 1, "malformed YAML: " + printable(error.msg));
  }
  if (!builder.root() || builder.root()->kind == YamlNode::Kind::null) {
    throw Error(file.string() + ": expected YAML, got an empty file");
  }
  return builder.root();
}

}  // namespace diminish
