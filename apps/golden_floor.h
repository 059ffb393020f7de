// The noise floor of golden cases: how far results move when only compiler and flags change. A tolerance below ten
// times that would fail on another machine; this measures it.
#pragma once

#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/baseline/golden_case.h"

namespace touchstone::apps {

// Runs `golden render` of each program and prints, per case and model, the largest share of the tolerance that any of
// them uses. Failed when a share exceeds a tenth.
ExitStatus golden_floor(const std::vector<GoldenCase>& cases, const std::string& golden,
                        const std::vector<std::string>& programs);

}  // namespace touchstone::apps
