// The states of the guard and the steps between them that are allowed. Tests hold the logs of real guards against this
// table (guard_fault_table_test.cc), and check a model that is built on it exhaustively (guard_transitions_test.cc).
#pragma once

#include "safety/guard_page.h"

namespace touchstone::hil {

// A state may always be entered again. Nothing leads back from letting go to a force.
constexpr bool may_follow(GuardPhase now, GuardPhase next) noexcept {
  if (now == next) return true;
  switch (now) {
    case GuardPhase::opening:
      return next == GuardPhase::at_zero;
    case GuardPhase::at_zero:
      return next == GuardPhase::pushing || next == GuardPhase::letting_go;
    case GuardPhase::pushing:
      // To off and rescue directly: the guard died, and driver or rescuer bring the device to rest.
      return next == GuardPhase::at_zero || next == GuardPhase::letting_go || next == GuardPhase::rescue ||
             next == GuardPhase::off;
    case GuardPhase::letting_go:
      return next == GuardPhase::off || next == GuardPhase::rescue;
    case GuardPhase::rescue:
      return next == GuardPhase::off || next == GuardPhase::unconfirmed;
    case GuardPhase::unconfirmed:
      return next == GuardPhase::off;
    case GuardPhase::off:
      return false;
  }
  return false;
}

// A new force may be commanded in this state alone.
constexpr bool may_push(GuardPhase phase) noexcept { return phase == GuardPhase::pushing; }

}  // namespace touchstone::hil
