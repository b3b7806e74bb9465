#pragma once

#include <stdexcept>
#include <string>

namespace diminish {

/// Input that cannot be used. The message is one line that names the file, the key or the camera,
/// and what was expected there.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace diminish
