// Brings a project on a CDash server to what Touchstone's dashboards need. The token must be a full-access one of a
// project administrator.
#pragma once

#include <string>
#include <vector>

#include "cdash_server.h"

namespace touchstone::dashboard {

struct CdashSetup {
  std::vector<std::string> groups{"HIL"};  // builds of a track without its group land in Experimental
  std::vector<std::string> pinned{"force_rms_N", "force_p99_N", "tolerance_used", "operations", "step_p99_us"};
  int upload_quota_GiB = 1;  // a new project takes ten bytes in all, and drops the rest without a word
};

// What was changed, one sentence each; nothing where all was as it should be. Throws BadData when the server refuses.
std::vector<std::string> set_up_project(CdashConnection& connection, const CdashSetup& wanted);

}  // namespace touchstone::dashboard
