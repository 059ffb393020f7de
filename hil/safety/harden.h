// Makes a process of the guard keep its time: real-time scheduling, memory that is not paged out, no end by the
// kernel's out-of-memory killer or by a signal from the terminal. Whatever the user's permissions do not allow is said.
#pragma once

#include <string>

namespace touchstone::hil {

enum class LockedMemory { present, also_future };  // also_future: only for processes that allocate nothing

// What could not be had, for the log; empty: all of it.
std::string harden(int priority, LockedMemory memory);

}  // namespace touchstone::hil
