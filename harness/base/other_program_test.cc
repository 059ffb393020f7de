#include "harness/base/other_program.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "harness/base/atomic_file.h"
#include "harness/base/scratch_folder.h"

namespace touchstone {
namespace {

std::optional<ProgramEnd> shell(const std::string& command) {
  return run_other({{"sh", "-c", command}, Printed::kept, Printed::kept});
}

TEST(OtherProgram, BothStreamsAreKeptApartHoweverLong) {
  const auto end = shell("head -c 300000 /dev/zero | tr '\\0' e >&2; head -c 200000 /dev/zero | tr '\\0' o; exit 3");
  ASSERT_TRUE(end);
  EXPECT_EQ(end->status, 3);
  EXPECT_EQ(end->out, std::string(200000, 'o'));
  EXPECT_EQ(end->err, std::string(300000, 'e'));
}

TEST(OtherProgram, ASignalIsAStatusAbove128) { EXPECT_EQ(shell("kill -9 $$")->status, 128 + 9); }

TEST(OtherProgram, WhatIsNotThereIsNoEnd) {
  EXPECT_FALSE(run_other({{"touchstone-no-such-program"}}));
  EXPECT_EQ(shell("touchstone-no-such-program")->status, 127);
}

TEST(OtherProgram, WordsReachItAsTheyAre) {
  const auto end = run_other({{"printf", "%s|", "a b", "", "$HOME", "*"}, Printed::kept});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->out, "a b||$HOME|*|");
}

TEST(OtherProgram, ReadsAFileAsItsInput) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "input_of_another_program.txt";
  std::ofstream(file) << "seven";
  const auto end = run_other({{"cat"}, Printed::kept, Printed::shown, file});
  ASSERT_TRUE(end);
  EXPECT_EQ(end->out, "seven");
  EXPECT_FALSE(run_other({{"cat"}, Printed::kept, Printed::dropped, file / "not there"}));
  std::filesystem::remove(file);
}

TEST(OtherProgram, PrintsIntoFilesInAFolderWithVariables) {
  const ScratchFolder scratch;
  OtherProgram program{{"sh", "-c", "pwd; echo $COLOUR $HOME; echo wrong >&2"}};
  program.out_file = scratch.path() / "out";
  program.err_file = scratch.path() / "log";
  program.folder = scratch.path();
  program.environment = {{"COLOUR", "red"}, {"HOME", "here"}};
  for (int i = 0; i < 2; ++i) ASSERT_EQ(run_other(program)->status, 0);
  EXPECT_EQ(read_file(program.out_file), std::filesystem::canonical(scratch.path()).string() + "\nred here\n");
  EXPECT_EQ(read_file(program.err_file), "wrong\nwrong\n") << "the log is added to";
  program.out_file.clear();
  program.out = Printed::with_errors;
  ASSERT_EQ(run_other(program)->status, 0);
  EXPECT_NE(read_file(program.err_file).find("red here\nwrong\n"), std::string::npos);
  program.err_file = scratch.path() / "no" / "log";
  EXPECT_FALSE(run_other(program));
}

// With all that it started, also what does not listen.
TEST(OtherProgram, IsEndedWhenAskedTo) {
  const ScratchFolder scratch;
  OtherProgram program{{"sh", "-c", "(trap '' TERM; exec sleep 600) & echo $! >child; wait"}};
  program.folder = scratch.path();
  const auto child = scratch.path() / "child";
  std::atomic<bool> stop = false;
  program.stop = &stop;
  std::thread stopper([&] {
    while (!std::filesystem::exists(child) || read_file(child).empty())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    stop = true;
  });
  EXPECT_THROW(run_other(program), Interrupted);
  stopper.join();
  const pid_t pid = std::stoi(read_file(child));
  // Soon gone, or a zombie that nobody has waited for.
  const auto runs = [&] {
    std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
    std::string text;
    std::getline(stat, text);
    return !text.empty() && text.find(") Z") == std::string::npos;
  };
  while (runs()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  stop = false;
  program.words = {"true"};
  EXPECT_EQ(run_other(program)->status, 0);
}

TEST(OtherProgram, WithoutATerminalItHasASessionOfItsOwn) {
  OtherProgram program{{"sh", "-c", "ps -o sid= -p $$ | tr -d ' '; echo $$"}, Printed::kept};
  program.without_terminal = true;
  const auto end = run_other(program);
  ASSERT_TRUE(end);
  const std::size_t line = end->out.find('\n');
  EXPECT_EQ(end->out.substr(0, line + 1), end->out.substr(line + 1)) << end->out;
}

}  // namespace
}  // namespace touchstone
