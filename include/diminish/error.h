#pragma once

#include <stdexcept>
#include <string>

#include "diminish/export.h"

namespace diminish {

/// Something cannot be used or done. The message is one line that names the file, key or camera and
/// what was expected.
class DIMINISH_EXPORT Error : public std::runtime_error {
 public:
  /// What a program can do about it.
  enum Category {
    configuration,  ///< rig.yaml, scene.yaml, options, arguments: correct what the message names
    input,          ///< images, lists and other data that are wrong
    device,         ///< a camera, GPU or display that is missing or fails: may work later
    io,             ///< a file, a folder or a port that cannot be read, written or opened
    internal,       ///< a bug in the library
  };

  /// A configuration error, like most.
  explicit Error(const std::string& message) : std::runtime_error(message) {}
  Error(Category category, const std::string& message)
      : std::runtime_error(message), category_(category) {}

  Category category() const { return category_; }

 private:
  Category category_ = configuration;
};

}  // namespace diminish
