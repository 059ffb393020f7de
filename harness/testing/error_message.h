// What an error says, for tests of messages.
#pragma once

#include <functional>
#include <string>

#include "harness/base/error.h"

namespace touchstone::testing {

// The message of the Expected error that the call throws, or "no error". Another kind of error passes through and fails
// the test.
template <class Expected = BadData>
std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Expected& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace touchstone::testing
