// `touchstone acquire run`, and the last step of `touchstone hil record --acquire`.
#pragma once

#include <string>

#include "apps/apps_rooms.h"
#include "harness/acquisition/acquire.h"
#include "harness/base/error.h"

namespace touchstone::apps {

// Makes the recording `out` and, where it is not empty, the report `json`; prints each step with its residual. Failed:
// the recording is written, but it is not sane, or something is touched in the interval that should be free air.
ExitStatus run_acquisition(const acquisition::AcquisitionDescription& description, const std::string& out,
                           const std::string& json);

}  // namespace touchstone::apps
