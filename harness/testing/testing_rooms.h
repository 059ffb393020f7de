#pragma once

#include "harness/base/rooms.h"

// The rooms that harness/testing may use, as in harness/base/rooms.h.

namespace touchstone::testing {
using namespace rendering;
using namespace recording;
using namespace surface;
}  // namespace touchstone::testing
