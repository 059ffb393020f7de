// What this build is: goes into every report and golden as provenance.
#pragma once

#include <string>

namespace touchstone {

struct BuildInfo {
  std::string version;     // semantic version, e.g. 0.1.0
  std::string commit;      // git commit at configure time, "unknown" outside a checkout
  bool dirty;              // uncommitted changes at build time
  std::string compiler;    // name and version
  std::string build_type;  // e.g. Release
  std::string flags;       // compile flags that bear on rounding
};

const BuildInfo& build_info();

}  // namespace touchstone
