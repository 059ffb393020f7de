#pragma once

#include "harness/base/rooms.h"

// The rooms that harness/pipeline may use, as in harness/base/rooms.h.

namespace touchstone::pipeline {
using namespace baseline;
using namespace discrepancy;
using namespace metrics;
using namespace plugin;
using namespace recording;
using namespace rendering;
using namespace runs;
using namespace sanity;
using namespace surface;
}  // namespace touchstone::pipeline
