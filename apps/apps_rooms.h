#pragma once

#include "harness/base/rooms.h"

// The rooms that the program uses beside those of harness/base/rooms.h.

namespace touchstone::apps {
using namespace pipeline;
}  // namespace touchstone::apps
