// A plug-in's result as a golden: the file says which library made it, from which commit, and nothing becomes a golden
// that cannot be traced. In a repository made here, with the plug-in of the plane in it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "harness/base/hash.h"
#include "harness/golden/golden_file.h"
#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;

class PluginGolden : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    testing::BuiltProgram::SetUp();
    if (IsSkipped()) return;
    std::filesystem::create_directories(folder_ / "repository/golden/tap");
    std::filesystem::create_directories(folder_ / "repository/build");
    write_file(folder_ / "repository/.gitignore", "build\n");
    write_file(folder_ / "repository/mine.c", "int stiffness = 1;\n");
    write_file(folder_ / "repository/golden/tap/case.json", R"({"schema": "touchstone-golden-case/1", "name": "tap",
      "summary": "a tap", "surface": {"name": "plane", "triangles": 50},
      "trajectory": {"name": "taps", "parameters": {"taps": 1, "period_s": 0.2}},
      "models": {"plane": {"schema": "touchstone-model/1", "renderer": "plane"}},
      "tolerance": {"reason": "of the test"}})");
    library_ = folder_ / "repository/build/libmine.so";
    std::filesystem::copy_file(testing::environment("TOUCHSTONE_TEST_PLUGINS") + "/NOTHING.so", library_);
    git("init -q -b main");
    commit();
  }

  void git(const std::string& words) const {
    const Outcome done = testing::run_command(
        "env -u GIT_DIR GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null git -C repository -c user.name=t -c "
        "user.email=t@example.org " +
            words,
        folder_);
    ASSERT_EQ(done.status, 0) << words << done.err;
  }
  void commit() const {
    git("add -A");
    git("commit -q -m next");
  }
  Outcome check(const std::string& more = "") const {
    return run("check --golden repository/golden --out pending --plugin " + library_.string() + " " + more);
  }
  Outcome accept() const {
    return testing::run_command(
        fmt::format("env -u CI '{}' golden accept --golden repository/golden --out pending --reason first", program_),
        folder_);
  }

  std::filesystem::path library_;
};

TEST_F(PluginGolden, SaysWhichLibraryOfWhichCommitMadeIt) {
  EXPECT_EQ(check().status, 1);
  const Outcome accepted = accept();
  ASSERT_EQ(accepted.status, 0) << accepted.err;
  const golden::Provenance golden = golden::read_provenance(folder_ / "repository/golden/tap/expected/plane.h5");
  EXPECT_EQ(golden.at("plugin_library"), "libmine.so") << "no path of this machine";
  EXPECT_EQ(golden.at("plugin_sha256"), sha256_file(library_));
  EXPECT_EQ(golden.at("plugin_state"), "clean");
  EXPECT_EQ(golden.at("plugin_commit").size(), 40U);
  EXPECT_EQ(check().status, 0);
}

// The tree is put right after the run: what counts is how it was when the plug-in ran.
TEST_F(PluginGolden, ADirtyTreeAtTheRunIsNotForgivenAfterwards) {
  write_file(folder_ / "repository/mine.c", "int stiffness = 2;\n");
  EXPECT_EQ(check().status, 1);
  git("checkout -q -- mine.c");
  const Outcome refused = accept();
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("changed: mine.c"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "repository/golden/tap/expected/plane.h5"));
}

TEST_F(PluginGolden, AnotherLibraryInItsPlaceIsNoticed) {
  EXPECT_EQ(check().status, 1);
  const auto permissions = std::filesystem::status(library_).permissions();
  std::filesystem::permissions(library_, permissions | std::filesystem::perms::owner_write);
  write_file(library_, read_file(library_) + "rebuilt");
  const Outcome refused = accept();
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("not the one that rendered it"));
}

TEST_F(PluginGolden, OutsideOfARepositoryItAsksWhereTheSourcesAre) {
  std::filesystem::create_directories(folder_ / "elsewhere");
  std::filesystem::copy_file(library_, folder_ / "elsewhere/libmine.so");
  library_ = folder_ / "elsewhere/libmine.so";
  EXPECT_EQ(check().status, 1);
  const Outcome refused = accept();
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--plugin-source"));
  EXPECT_EQ(check("--plugin-source repository").status, 1);
  const Outcome accepted = accept();
  EXPECT_EQ(accepted.status, 0) << accepted.err;
}

TEST_F(PluginGolden, AStandInsResultIsNoGolden) {
  EXPECT_EQ(check("--renderer spring-linear").status, 1);
  const Outcome refused = accept();
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("spring-linear"));
}

}  // namespace
}  // namespace touchstone::apps
