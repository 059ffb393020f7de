// A renderer under test that breaks down is a failure of the renderer (exit status 1), not of the user's data.
#pragma once

#include <string>

#include "harness/base/error.h"

namespace touchstone::rendering {

// It crashed, hung, or answered with what is no number. The message says which, where in the run, and with what input.
class RendererFailed : public Error {
 public:
  explicit RendererFailed(const std::string& message) : Error(ExitStatus::failed, message) {}
};

}  // namespace touchstone::rendering
