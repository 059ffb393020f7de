// Tries something in a child process that a library might not survive, so that a damaged file cannot take the program
// down with it.
#pragma once

#include <cstdint>
#include <functional>

namespace touchstone::recording {

enum class ChildOutcome : std::uint8_t {
  survived,    // returned or threw
  crashed,     // killed by a signal, or stopped by a sanitizer
  no_verdict,  // could not be started, or took more than two minutes
};

// Runs `work` in a fork of this process; nothing it does is seen here, and what it prints is dropped. `work` must not
// need other threads.
ChildOutcome try_in_child(const std::function<void()>& work);

}  // namespace touchstone::recording
