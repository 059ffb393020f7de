#pragma once

#include "harness/base/rooms.h"

// The rooms that harness/tool may use, as in harness/base/rooms.h. Rooms that use harness/tool say so where they do
// (renderers/tool, synthetic/tool): code without tools does not see its names.

namespace touchstone::tool {
using namespace recording;
using namespace rendering;
using namespace surface;
}  // namespace touchstone::tool
