#define TOUCHSTONE_COMPILED_ONCE
#include "harness/base/compiled_once.h"
