#include "harness/base/input_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone {
namespace {

namespace fs = std::filesystem;

std::string read_as_input(const fs::path& path) {
  note_input_file(path);
  return read_file(path);
}

class InputFiles : public testing::Test {
 protected:
  InputFiles() { ensure_writable_folder(folder_); }
  ~InputFiles() override { fs::remove_all(folder_); }

  // Protection lasts to the end of a process: each trial has one of its own. True when nothing failed in it.
  static bool in_a_program(const std::function<void()>& trial) {
    const pid_t child = ::fork();
    if (child == 0) {
      protect_input_files();
      trial();
      ::_exit(testing::Test::HasFailure() ? 1 : 0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  [[nodiscard]] fs::path at(const char* name) const { return folder_ / name; }

  fs::path folder_ = fs::path(testing::TempDir()) / ("touchstone-inputs-" + std::to_string(::getpid()));
};

TEST_F(InputFiles, AreNotReplacedWhateverTheyAreCalled) {
  write_file(at("in.csv"), "measured");
  fs::create_hard_link(at("in.csv"), at("hard.csv"));
  fs::create_symlink("in.csv", at("soft.csv"));
  fs::create_directory_symlink(folder_, at("other-way"));
  for (const fs::path& name :
       {at("in.csv"), at("hard.csv"), at("soft.csv"), at("other-way") / "in.csv", at("other-way") / "../in.csv"}) {
    EXPECT_TRUE(in_a_program([&] {
      EXPECT_EQ(read_as_input(at("in.csv")), "measured");
      if (!fs::exists(name)) return;
      EXPECT_THROW(write_file(name, "rendered"), UsageError) << name;
      EXPECT_THROW(refuse_to_replace_input(name), UsageError) << name;
    }));
    EXPECT_EQ(read_as_input(at("in.csv")), "measured") << name;
  }
}

TEST_F(InputFiles, TheMessageNamesBothNames) {
  write_file(at("in.csv"), "measured");
  fs::create_hard_link(at("in.csv"), at("hard.csv"));
  EXPECT_TRUE(in_a_program([&] {
    read_as_input(at("in.csv"));
    try {
      refuse_to_replace_input(at("hard.csv"));
      ADD_FAILURE() << "was allowed";
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("hard.csv"), testing::HasSubstr("in.csv, which"),
                                               testing::HasSubstr("another name")));
    }
  }));
}

TEST_F(InputFiles, OthersAndWhatTheProgramWroteItselfMayBeReplaced) {
  write_file(at("in.csv"), "measured");
  write_file(at("old.csv"), "yesterday");
  EXPECT_TRUE(in_a_program([&] {
    read_as_input(at("in.csv"));
    write_file(at("old.csv"), "first");
    EXPECT_EQ(read_as_input(at("old.csv")), "first");
    write_file(at("old.csv"), "second");
    write_file(at("in.csv"), "changed on purpose", Replace::inputs_too);
    EXPECT_EQ(read_as_input(at("in.csv")), "changed on purpose");
  }));
  EXPECT_EQ(read_as_input(at("old.csv")), "second");
}

// File numbers are given again: an input that is gone protects no file that came by its number.
TEST_F(InputFiles, OneThatIsGoneProtectsNothing) {
  EXPECT_TRUE(in_a_program([&] {
    for (int i = 0; i < 20; ++i) {
      std::ofstream(at("scratch.txt")) << i;
      read_as_input(at("scratch.txt"));
      fs::remove(at("scratch.txt"));
      std::ofstream(at("result.txt")) << i;
      write_file(at("result.txt"), "again");
    }
  }));
}

TEST_F(InputFiles, LibrariesAreNotConcerned) {
  write_file(at("in.csv"), "measured");
  read_as_input(at("in.csv"));
  EXPECT_NO_THROW(write_file(at("in.csv"), "changed"));
}

TEST_F(InputFiles, ASymbolicLinkStaysOneAndItsFileIsReplaced) {
  write_file(at("kept.csv"), "old");
  fs::create_symlink("kept.csv", at("link.csv"));
  write_file(at("link.csv"), "new");
  EXPECT_TRUE(fs::is_symlink(at("link.csv")));
  EXPECT_EQ(read_as_input(at("kept.csv")), "new");
  fs::create_symlink("not-yet.csv", at("ahead.csv"));
  write_file(at("ahead.csv"), "made");
  EXPECT_EQ(read_as_input(at("not-yet.csv")), "made");
}

TEST_F(InputFiles, ADeviceIsWrittenAndStaysADevice) {
  EXPECT_THROW(write_file("/dev/full", "anything"), BadData);
  EXPECT_EQ(fs::status("/dev/full").type(), fs::file_type::character);
  EXPECT_NO_THROW(write_file("/dev/null", "anything"));
  EXPECT_EQ(fs::status("/dev/null").type(), fs::file_type::character);
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  const pid_t reader = ::fork();
  if (reader == 0) {
    std::ifstream in(at("pipe"));
    std::string text;
    in >> text;
    ::_exit(text == "through" ? 0 : 1);
  }
  write_file(at("pipe"), "through");
  int status = 1;
  ::waitpid(reader, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(fs::is_fifo(at("pipe")));
}

}  // namespace
}  // namespace touchstone
