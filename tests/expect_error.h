#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "diminish/error.h"

namespace diminish {

/// The message of the Error that `call` throws. Fails the test if there is no Error or its message
/// has several lines.
template <class Call>
std::string error_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << "expected an Error";
  return "";
}

}  // namespace diminish
