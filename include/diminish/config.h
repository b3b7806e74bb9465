#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "diminish/export.h"

namespace diminish {

/// A place in a YAML file. It knows its file, line and key, so that every message names them:
/// "scene.yaml:4: occluders[0].marker.size_m: expected a number above 0, got '-1'". All readers
/// throw Error. Cheap to copy.
class DIMINISH_EXPORT Config {
 public:
  /// Nothing: `exists()` is false.
  Config();
  ~Config();
  Config(const Config&);
  Config& operator=(const Config&);
  Config(Config&&) noexcept;
  Config& operator=(Config&&) noexcept;

  static Config load(const std::filesystem::path& file);
  /// For tests and programs that hold their configuration in memory. `file` appears in messages.
  static Config parse(const std::string& yaml, const std::filesystem::path& file = "(text)");

  bool exists() const;
  /// The file it comes from. Paths in it are relative to its folder.
  const std::filesystem::path& file() const;

  /// Throws Error if there are keys that are not in `known`, so that typing errors are not silently
  /// ignored.
  void expect_keys(std::initializer_list<const char*> known) const;
  void expect_keys(const std::vector<std::string>& known) const;
  /// The value of a key of this map. Throws Error if it is missing.
  Config at(const std::string& key) const;
  /// The same, but if the key is missing, the result's `exists()` is false. A place that does not
  /// exist has no keys either.
  Config find(const std::string& key) const;
  /// The items of this list.
  std::vector<Config> items() const;
  /// The keys of this map, in the file's order.
  std::vector<std::string> keys() const;

  std::string text() const;
  /// One of `choices`.
  std::string choice(std::initializer_list<const char*> choices) const;
  int integer(int min, int max) const;
  double number() const;           ///< finite
  double positive_number() const;  ///< finite and above 0
  std::vector<double> numbers(std::size_t count) const;
  Eigen::Vector3d vector3() const;
  /// A path, relative to this file's folder.
  std::filesystem::path path() const;

  /// Throws Error with this place in front: "rig.yaml:3: color.width: " + message.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  struct Node;
  explicit Config(std::shared_ptr<const Node> node);
  std::shared_ptr<const Node> node_;
};

}  // namespace diminish
