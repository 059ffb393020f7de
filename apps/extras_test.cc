// Programs touchstone-NAME as commands: found, listed, completed, and never in the place of a command of the program.
#include <gmock/gmock.h>

#include <set>
#include <sstream>

#include "apps/commands.h"
#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;

class Extras : public testing::BuiltProgram {
 protected:
  // A script touchstone-NAME in folder_/more.
  void add(const std::string& name, const std::string& script) {
    const auto file = folder_ / "more" / ("touchstone-" + name);
    std::filesystem::create_directories(file.parent_path());
    write_file(file, script);
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  // With folder_/more last on PATH.
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return testing::run_command(
        fmt::format("PATH=\"$PATH:/nowhere:{}\" '{}' {}", (folder_ / "more").string(), program_, arguments), folder_);
  }
};

TEST_F(Extras, RunWithTheirWordsAndTheirExitStatus) {
  add("hello", "#!/bin/sh\nprintf '<%s>' \"$@\" \"$TOUCHSTONE_PROGRAM\"\nexit 7\n");
  const Outcome hello = run("hello 'two words' --mu 0.3 --help");
  EXPECT_EQ(hello.status, 7);
  EXPECT_EQ(hello.out, fmt::format("<two words><--mu><0.3><--help><{}>", program_));
  EXPECT_EQ(hello.err, "");
}

TEST_F(Extras, AreListedAndCompletedAndMeant) {
  add("hello", "#!/bin/sh\n");
  EXPECT_THAT(run("--help").out, HasSubstr(fmt::format("hello ({}/more/touchstone-hello)", folder_.string())));
  EXPECT_THAT(run("completion bash").out, HasSubstr(" hello"));
  const Outcome misspelt = run("helo");
  EXPECT_EQ(misspelt.status, 2);
  EXPECT_THAT(misspelt.err, HasSubstr("did you mean \"hello\"?"));
}

TEST_F(Extras, ComeAfterTheCommandsOfTheProgram) {
  add("version", "#!/bin/sh\necho another\n");
  add("doctor", "#!/bin/sh\necho another\n");
  EXPECT_THAT(run("version").out, Not(HasSubstr("another")));
  EXPECT_THAT(run("doctor --help").out, Not(HasSubstr("another")));
  EXPECT_THAT(run("--help").out, Not(HasSubstr("more/touchstone-")));
}

TEST_F(Extras, AreFilesThatCanBeRun) {
  add("hello", "#!/bin/sh\n");
  std::filesystem::permissions(folder_ / "more" / "touchstone-hello", std::filesystem::perms::owner_read);
  EXPECT_EQ(run("hello").status, 2);
  std::filesystem::create_directories(folder_ / "more" / "touchstone-folder");
  EXPECT_EQ(run("folder").status, 2);
  EXPECT_EQ(run("../more/touchstone-hello").status, 2);
  add("broken",
      "\x7f"
      "ELF nothing\n");
  const Outcome broken = run("broken");
  EXPECT_EQ(broken.status, 2);
  EXPECT_THAT(broken.err, HasSubstr("more/touchstone-broken: Exec format error"));
}

// `touchstone` looks for extras among the words that it does not know, and has the names of its commands from a list.
TEST_F(Extras, AreLookedForBesideTheNamesOfAllCommands) {
  std::set<std::string_view> names(light_command_names.begin(), light_command_names.end());
  names.insert(heavy_command_names.begin(), heavy_command_names.end());
  std::set<std::string> commands;
  std::istringstream lines(run("--help").out);
  for (std::string line; std::getline(lines, line) && line != "Subcommands:";) {
  }
  for (std::string line; std::getline(lines, line) && line.starts_with("  ");) {
    if (line[2] != ' ') commands.insert(line.substr(2, line.find(' ', 2) - 2));
  }
  EXPECT_THAT(commands, ::testing::ElementsAreArray(names));
}

// touchstone-full and the like are how the program is made or tested, no commands; in a build folder they stand beside
// it.
TEST_F(Extras, AreNotThePartsOfTheProgram) {
  for (const char* const part : {"full", "plugin-host", "test-result", "emulated-lab"}) {
    add(part, "#!/bin/sh\n");
    EXPECT_THAT(run("--help").out, Not(HasSubstr(fmt::format(" {} (", part)))) << part;
    const Outcome run_part = run(part);
    EXPECT_EQ(run_part.status, 2) << part;
    EXPECT_THAT(run_part.err, HasSubstr("there is no command")) << part;
  }
}

// `fit` and `discrepancy` leave a recording of one axis to touchstone-axis, which comes before any other on PATH.
TEST_F(Extras, ARecordingOfOneAxisIsFittedByTheExtra) {
  add("axis", "#!/bin/sh\nprintf '<%s>' \"$@\"\nexit 3\n");
  write_file(folder_ / "joint.csv", "t_s,q_rad,torque_Nm\n0,0,1\n0.1,0.1,1.1\n");
  const auto bare = folder_ / "bare";  // a program without extras beside it
  std::filesystem::create_directories(bare);
  for (const char* const name : {"touchstone", "touchstone-full"})
    std::filesystem::create_hard_link(std::filesystem::path(program_).parent_path() / name, bare / name);
  const auto with_path = [&](const std::string& path, const std::string& words) {
    return testing::run_command(fmt::format("PATH='{}' '{}' {}", path, (bare / "touchstone").string(), words), folder_);
  };
  const std::string path = "/usr/bin:/bin:" + (folder_ / "more").string();
  const Outcome fit = with_path(path, "fit --recording joint.csv --repeat joint.csv --out joint");
  EXPECT_EQ(fit.status, 3) << fit.err;
  EXPECT_EQ(fit.out, "<joint.csv><--repeat><joint.csv><--out><joint>");
  EXPECT_EQ(with_path(path, "discrepancy --recording joint.csv --flip-force --out d").out,
            "<joint.csv><--out><d><--flip-force>");
  const Outcome useless = with_path(path, "fit --recording joint.csv --mesh object.obj");
  EXPECT_EQ(useless.status, 2);
  EXPECT_THAT(useless.err, HasSubstr("--mesh: joint.csv is a recording of one axis, which has no use for it"));
  for (const std::string option :
       {"--model m.json", "--mesh o.obj", "--holdout h.csv", "--instrument i.json", "--tolerance 0.1",
        "--tolerance noticed", "--effect e.json", "--golden g", "--verify"}) {
    const Outcome refused = with_path(path, "discrepancy --recording joint.csv --out d " + option);
    EXPECT_EQ(refused.status, 2) << option;
    EXPECT_THAT(refused.err, HasSubstr(option.substr(0, option.find(' ')) + ": joint.csv is a recording of one axis"));
  }
  const Outcome without = with_path("/usr/bin:/bin", "fit --recording joint.csv");
  EXPECT_EQ(without.status, 2);
  EXPECT_THAT(without.err, HasSubstr("touchstone-axis is neither beside this one nor on PATH"));
}

}  // namespace
}  // namespace touchstone::apps
