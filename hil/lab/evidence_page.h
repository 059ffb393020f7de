// The evidence of a lab's run as a page: what was measured, against which limits, with pictures, and by which device.
#pragma once

#include <filesystem>

#include "harness/report/page.h"

namespace touchstone::hil {

struct EvidencePage {
  report::Page page;
  bool emulated = false;
  int tests = 0;
  int failed = 0;
};

// From a folder of evidence files (hil/lab/evidence.h). Throws BadData where there is none, where one cannot be read,
// and where emulated and hardware results lie in one folder: those never stand on one page.
EvidencePage evidence_page(const std::filesystem::path& folder);

}  // namespace touchstone::hil
