#pragma once

#include <stdexcept>
#include <string>

#include "diminish/export.h"

namespace diminish {

/// Something that cannot be used or done. The message is one line that names the file, the key or
/// the camera, and what was expected there.
class DIMINISH_EXPORT Error : public std::runtime_error {
 public:
  /// What a program may do about it.
  enum Category {
    configuration,  ///< rig.yaml, scene.yaml, options, arguments: correct what the message names
    input,          ///< images, lists and other data that are not what they should be
    device,         ///< a camera, a GPU or a display that is not there or fails: may work later
    io,             ///< a file, a folder or a port that cannot be read, written or opened
    internal,       ///< a fault of the library
  };

  /// Of the configuration, as most are.
  explicit Error(const std::string& message) : std::runtime_error(message) {}
  Error(Category category, const std::string& message)
      : std::runtime_error(message), category_(category) {}

  Category category() const { return category_; }

 private:
  Category category_ = configuration;
};

}  // namespace diminish
