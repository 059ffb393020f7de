#include "harness/base/other_program.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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
