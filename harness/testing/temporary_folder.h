// A folder of one test's own, empty at first, gone with the object.
#pragma once

#include <gtest/gtest.h>

#include "harness/base/scratch_folder.h"

namespace touchstone::testing {

struct TemporaryFolder : ScratchFolder {
  TemporaryFolder() : ScratchFolder(::testing::TempDir()) {}
};

}  // namespace touchstone::testing
