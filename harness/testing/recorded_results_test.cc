#include "harness/testing/recorded_results.h"

#include <gtest/gtest.h>

#include "harness/base/atomic_file.h"
#include "harness/testing/result_recorder.h"

namespace touchstone::testing {
namespace {

TEST(RecordedResults, OnlyThoseOfThisCtestRunCount) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-conformance-results";
  std::filesystem::remove_all(folder);
  const std::string test = "Plugin/RendererConformance.NoForceInFreeSpace/mine_cube";
  EXPECT_FALSE(recorded_result(folder, test).has_value());

  // What an earlier run left is removed, what somebody else put there is not.
  std::filesystem::create_directories(folder / "12-345");
  std::filesystem::create_directories(folder / "notes");
  const ResultRecorder recorder(folder);
  EXPECT_FALSE(std::filesystem::exists(folder / "12-345"));
  EXPECT_TRUE(std::filesystem::exists(folder / "notes"));

  write_file(results_of_this_run(folder) / "Plugin.RendererConformance.NoForceInFreeSpace.mine_cube",
             "1\na.h:7: two\nlines\n");
  const auto found = recorded_result(folder, test);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->status, 1);
  EXPECT_EQ(found->text, "a.h:7: two\nlines\n");
  EXPECT_FALSE(recorded_result(folder, test + "s").has_value());

  // What is no whole outcome passes for none.
  for (const char* const cut : {"", "0", "2\n", "passed\n", "-0 \n"}) {
    write_file(result_file(folder, test), cut);
    EXPECT_FALSE(recorded_result(folder, test).has_value()) << cut;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace touchstone::testing
