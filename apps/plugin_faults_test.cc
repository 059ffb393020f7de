// Tests of the tests: each fault planted in the example plug-in is caught by a named test of those that any plug-in
// gets, and without a fault all of them pass. The table that this prints says which tests fail for which fault.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "harness/testing/built_program.h"
#include "harness/testing/temporary_folder.h"

namespace touchstone::apps {
namespace {

using testing::environment;
using testing::Outcome;

std::string plugin(const std::string& fault) { return environment("TOUCHSTONE_FAULTY_PLUGINS") + "/" + fault + ".so"; }

// The tests that failed, without their shapes: "StepAllocatesNothing", "golden plane-taps".
std::set<std::string> failing_tests(const std::string& fault, const std::string& caught_by = {},
                                    const std::string& options = {}) {
  std::set<std::string> failed;
  const auto folder = std::filesystem::path(::testing::TempDir()) / ("touchstone-plugin-fault-" + fault + caught_by);
  std::filesystem::create_directories(folder);
  const auto run = [&](const std::string& command) { return testing::run_command(command, folder); };
  // A fault shows on the small shapes, where the example's search through all triangles is quick, or by its own name.
  const std::string tests = caught_by.empty() ? "*" : "*_cube:*_plate:*_sheet:*TheForceIs*:*" + caught_by + "*";
  const Outcome suite = run(fmt::format("{} --plugin={} {} --no-cases --gtest_filter='{}'",
                                        environment("TOUCHSTONE_CONFORMANCE"), plugin(fault), options, tests));
  for (const std::string mark :
       {"[  FAILED  ] Plugin/RendererConformance.", "[  FAILED  ] Plugin/RendererBehaviour."}) {
    for (std::size_t at = suite.out.find(mark); at != std::string::npos; at = suite.out.find(mark, at + 1)) {
      const std::size_t begin = at + mark.size();
      failed.insert(suite.out.substr(begin, suite.out.find('/', begin) - begin));
    }
  }
  EXPECT_EQ(suite.status, failed.empty() ? 0 : 1) << suite.out;
  // An author reads what was pressed, what came, and what may be declared; not an expression of the suite's.
  EXPECT_EQ(suite.out.find("Value of:"), std::string::npos) << suite.out;
  EXPECT_EQ(suite.out.find("Expected: ("), std::string::npos) << suite.out;
  if (!failed.empty()) {
    EXPECT_THAT(suite.out,
                ::testing::AnyOf(::testing::HasSubstr(" declares \""), ::testing::HasSubstr("no ability covers this")));
  }
  for (const char* const golden : {"plane-taps", "sphere-scan"}) {
    const Outcome check =
        run(fmt::format("{} check {} --model spring-linear --renderer penalty-in-c --plugin {} --golden {} --out '{}'",
                        environment("TOUCHSTONE_PROGRAM"), golden, plugin(fault),
                        environment("TOUCHSTONE_SOURCE_DIR") + "/golden", (folder / "pending").string()));
    EXPECT_TRUE(check.status == 0 || check.status == 1) << check.err;
    if (check.status != 0) failed.insert(std::string("golden ") + golden);
  }
  std::filesystem::remove_all(folder);
  return failed;
}

// A crash takes the test program with it; the test then says where all the same.
TEST(PluginCrash, SaysInWhichFunctionAtWhichStepAndWhereTheTipWas) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-plugin-crash";
  std::filesystem::create_directories(folder);
  const Outcome outcome =
      testing::run_command(fmt::format("{} --plugin={}/CRASHES_IN_STEP.so --gtest_filter='*StepAllocatesNothing*_cube'",
                                       environment("TOUCHSTONE_CONFORMANCE"), environment("TOUCHSTONE_TEST_PLUGINS")),
                           folder);
  EXPECT_EQ(outcome.status, 1) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, ::testing::AllOf(::testing::HasSubstr("crashed (SIG"), ::testing::HasSubstr("p_W_m")));
  std::filesystem::remove_all(folder);
}

// Whoever runs the suite and whoever looks at the scorecard learn the same of the golden cases: the example, which has
// no memory, is right in the place of a spring and leaves a thin shell on the far side in that of a god-object.
TEST(PluginGoldenCases, TheSuiteAndTheScorecardAgree) {
  const testing::TemporaryFolder folder;
  const auto golden = folder.path() / "golden";
  for (const char* const name : {"plane-taps", "shell-thin-push"}) {
    std::filesystem::create_directories(golden);
    std::filesystem::copy(environment("TOUCHSTONE_SOURCE_DIR") + "/golden/" + name, golden / name,
                          std::filesystem::copy_options::recursive);
  }
  const auto run = [&](const char* variable, const std::string& options) {
    return testing::run_command(fmt::format("{} {} --plugin={} --golden={}", environment(variable), options,
                                            plugin("NO_FAULT"), golden.string()),
                                folder.path());
  };
  const auto suite = [&](const std::string& options) {
    return run("TOUCHSTONE_CONFORMANCE", "--gtest_filter='*GoldenCases*' " + options);
  };
  const Outcome scorecard = run("TOUCHSTONE_PROGRAM", "scorecard --no-cost --plugin-in-process");
  EXPECT_EQ(scorecard.status, 1) << scorecard.out << scorecard.err;
  const Outcome failed = suite("");
  EXPECT_EQ(failed.status, 1) << failed.out << failed.err;
  EXPECT_THAT(failed.out,
              ::testing::HasSubstr("[  FAILED  ] Plugin/GoldenCases.AHandNoticesNoError/penalty_in_c_shell_thin_push"));
  EXPECT_EQ(suite("--allow=shell-thin-push").status, 0);
  EXPECT_EQ(suite("--model=spring-linear").status, 0);
  EXPECT_EQ(suite("--allow=shell-thick-push").status, 2);
}

struct Fault {
  std::string name;
  std::string caught_by;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class PluginFault : public ::testing::TestWithParam<Fault> {};

TEST_P(PluginFault, IsCaughtByTheTestThatIsNamed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  if (GetParam().name == "ALLOCATES_IN_STEP") GTEST_SKIP() << "the sanitizer has its own malloc, which is not counted";
#endif
  const auto failed = failing_tests(GetParam().name, GetParam().caught_by);
  fmt::print("| {} | {} |\n", GetParam().name, fmt::join(failed, ", "));
  EXPECT_THAT(failed, ::testing::Contains(GetParam().caught_by));
}

INSTANTIATE_TEST_SUITE_P(Planted, PluginFault,
                         ::testing::Values(Fault{"WRONG_SIGN", "ForceStaysInTheFrictionConeAndNeverPulls"},
                                           Fault{"STIFFNESS_ONE_PERCENT", "golden sphere-scan"},
                                           Fault{"ONE_SAMPLE_DELAY", "TheForceIsThatOfTheTipNow"},
                                           Fault{"OUTSIDE_FRICTION_CONE", "ForceStaysInTheFrictionConeAndNeverPulls"},
                                           Fault{"ALLOCATES_IN_STEP", "StepAllocatesNothing"},
                                           Fault{"TURNS_WITH_THE_TIP", "TheForceTurnsWithTheWorldAndNotWithTheTip"},
                                           Fault{"LOSES_SMALL_TRIANGLES", "SmallTrianglesAreFeltAsLargeOnes"},
                                           Fault{"DEPENDS_ON_UNIT", "TheUnitOfLengthChangesNothing"},
                                           Fault{"SHARES_ITS_MEMORY", "TwoOnOneSurfaceDoNotDisturbOneAnother"},
                                           Fault{"COSTS_MORE_EVERY_STEP", "TheCostDoesNotGrowWithTheSteps"},
                                           Fault{"SPIKES_LATE", "NoStepOfAMillionIsASpike"},
                                           Fault{"STIFFER_TRIANGLE", "TheForceDoesNotJumpFromTriangleToTriangle"},
                                           Fault{"HOLDS_ITS_ANSWER", "TheForceIsThatOfTheTipNow"},
                                           Fault{"SATURATES", "TheForceIsAlongTheNormalUpToTenNewtons"},
                                           Fault{"INVERTED_FACE", "EveryFaceAnswersAsItsNeighbours"}),
                         [](const auto& tested) { return tested.param.name; });

TEST(PluginFaults, AFaultThatIsAllowedFailsNothing) {
  EXPECT_THAT(failing_tests("SATURATES", "TheForceIsAlongTheNormal", "--allow=saturation"), ::testing::IsEmpty());
}

// The example has no friction; who says of it that it has finds that it is lost.
TEST(PluginFaults, FrictionThatIsDeclaredAndLostIsCaught) {
  EXPECT_THAT(failing_tests("NO_FAULT", "DeclaredFrictionIsFelt", "--friction=0.4"),
              ::testing::ElementsAre("DeclaredFrictionIsFelt"));
}

TEST(PluginFaults, WithoutOneEveryTestPasses) { EXPECT_THAT(failing_tests("NO_FAULT"), ::testing::IsEmpty()); }

}  // namespace
}  // namespace touchstone::apps
