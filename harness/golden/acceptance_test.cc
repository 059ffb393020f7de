#include "harness/golden/acceptance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/hash.h"

namespace touchstone::golden {
namespace {

using ::testing::HasSubstr;

class Acceptance : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("touchstone-acceptance-") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

TEST_F(Acceptance, NothingIsRemovedThroughASymbolicLink) {
  std::filesystem::create_directories(folder_ / "others/god-object");
  write_file(folder_ / "others/god-object/thesis.txt", "years of work");
  std::filesystem::create_directories(folder_ / "out/linked-model");
  std::filesystem::create_directory_symlink(folder_ / "others", folder_ / "out/linked-case");
  std::filesystem::create_directory_symlink(folder_ / "others/god-object", folder_ / "out/linked-model/god-object");
  for (const char* const case_name : {"linked-case", "linked-model"}) {
    try {
      clear_result_folder(result_folder(folder_ / "out", case_name, "god-object"));
      FAIL() << case_name;
    } catch (const BadData& error) {
      EXPECT_THAT(error.what(), HasSubstr("symbolic link"));
      EXPECT_THAT(error.what(), HasSubstr(case_name));
    }
  }
  EXPECT_EQ(read_file(folder_ / "others/god-object/thesis.txt"), "years of work");
}

TEST_F(Acceptance, AResultFolderIsClearedAndALinkInItIsOnlyItselfRemoved) {
  write_file(folder_ / "kept.txt", "kept");
  const auto results = folder_ / "out/case/model";
  std::filesystem::create_directories(results / "more");
  write_file(results / "obtained.h5", "x");
  std::filesystem::create_symlink(folder_ / "kept.txt", results / "link");
  clear_result_folder(result_folder(folder_ / "out", "case", "model"));
  EXPECT_FALSE(std::filesystem::exists(results));
  EXPECT_EQ(read_file(folder_ / "kept.txt"), "kept");
  EXPECT_NO_THROW(clear_result_folder(results)) << "what is not there is clear";
}

TEST_F(Acceptance, ARunWithAPluginThatIsNotTraceableIsRefused) {
  const auto library = folder_ / "libmine.so";
  write_file(library, "the library");
  const Provenance clean{{"plugin_library", library.string()},
                         {"plugin_sha256", sha256_file(library)},
                         {"plugin_commit", "0123"},
                         {"plugin_state", "clean"}};
  EXPECT_EQ(run_refused({}), std::nullopt) << "no plug-in, nothing to trace";
  EXPECT_EQ(run_refused(clean), std::nullopt);
  const auto with = [&](const char* name, const char* value) {
    Provenance changed = clean;
    changed[name] = value;
    return run_refused(changed).value_or("");
  };
  EXPECT_THAT(with("plugin_state", "changed: mine.c"), HasSubstr("mine.c"));
  EXPECT_THAT(with("plugin_state", ""), HasSubstr("not clean"));
  EXPECT_THAT(with("plugin_library", "/nowhere/libmine.so"), HasSubstr("no longer there"));
  EXPECT_THAT(with("renderer_in_place", "spring"), HasSubstr("--renderer"));
  write_file(library, "another library");
  EXPECT_THAT(run_refused(clean).value_or(""), HasSubstr("not the one that rendered it"));
}

}  // namespace
}  // namespace touchstone::golden
