#include "harness/bisection/reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::bisection {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Reference, TheModelIsTheOnlyOneOrTheFirstWithAGolden) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT([&] { model_in(folder.path()); }, ThrowsMessage<UsageError>(HasSubstr("holds no model file")));
  write_file(folder.path() / "b.json", "{}");
  EXPECT_EQ(model_in(folder.path()), "b");
  for (const char* const name : {"a.json", "c.json", "d.json", "c.golden.csv", "d.h5"})
    write_file(folder.path() / name, "");
  EXPECT_EQ(model_in(folder.path()), "c");
}

TEST(Reference, ACaseThatCannotBeExportedIsSaidWithTheOutput) {
  const testing::TemporaryFolder folder;
  const std::atomic<bool> stopped = false;
  write_file(folder.path() / "program", "#!/bin/sh\necho there is no such case >&2\nexit 2\n");
  std::filesystem::permissions(folder.path() / "program", std::filesystem::perms::owner_all);
  EXPECT_THAT(
      [&] {
        export_reference({folder.path() / "program", "nothing", ""}, folder.path() / "to", folder.path() / "log",
                         stopped);
      },
      ThrowsMessage<UsageError>(HasSubstr("there is no such case")));
}

}  // namespace
}  // namespace touchstone::bisection
