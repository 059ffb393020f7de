#pragma once

#include "apps/apps_rooms.h"

// The rooms that the blind test uses, as in harness/base/rooms.h.

namespace touchstone::blind {
using namespace apps;
}  // namespace touchstone::blind
