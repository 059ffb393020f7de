// What this build is: goes into every report and golden as provenance.
#pragma once

#include <string>

namespace touchstone {

struct BuildInfo {
  std::string version;     // semantic version, e.g. 0.1.0
  std::string commit;      // git commit when the program was linked; "unknown" outside a checkout
  bool dirty = false;      // uncommitted changes then
  std::string compiler;    // name and version
  std::string build_type;  // e.g. Release
  std::string flags;       // compile flags that bear on rounding
};

const BuildInfo& build_info();

struct SourceState {
  const char* commit;
  bool dirty;
};

// The library's own answer is "unknown": programs carry theirs (touchstone_carry_commit in
// cmake/TouchstoneCommit.cmake), so that a new commit links those few again and nothing else.
SourceState source_state();

}  // namespace touchstone
