#pragma once

#include <new>
#include <string>

namespace diminish {

/// Sets a text, or where there is no memory for it, says so. For handlers of what a thread must not
/// throw.
inline void set_text(std::string& text, const char* what) noexcept {
  try {
    text = what;
  } catch (const std::bad_alloc&) {
    text = "no memory";  // which a string holds within itself
  }
}

}  // namespace diminish
