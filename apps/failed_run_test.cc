// A command that fails leaves the tree as it was: no folder of --out, no file. Every command that takes --out, with an
// input that is missing, an option that does not exist, and an input that cannot be used.
#include <fmt/ranges.h>

#include <map>
#include <set>
#include <sstream>

#include "harness/testing/built_program.h"

namespace touchstone::apps {
namespace {

using testing::Outcome;

struct Failing {
  std::string missing;  // arguments that name a file "absent..."; "" where the command reads none
  std::string bad;      // arguments that name what cannot be used
};

// By the command's words. `--out` is added.
const std::map<std::string, Failing>& failing_commands() {
  static const std::string tool = "--renderer god-object-tool --tool mesh.obj --object ";
  static const std::map<std::string, Failing> all{
      {"acquire run", {"absent.json", "bad.json"}},
      {"atlas", {"--merge absent.sqlite", "--merge bad.csv"}},
      {"axis", {"absent.csv", "bad.csv"}},
      {"bisect", {"--repository absent --good HEAD~1 --bad HEAD", "--repository . --good HEAD~1 --bad HEAD"}},
      {"check", {"--golden absent", "--golden bad-golden"}},
      {"dataset pack", {"absent", "."}},
      {"discrepancy",
       {"--recording absent.csv --mesh mesh.obj --model model.json",
        "--recording bad.csv --mesh mesh.obj --model model.json"}},
      {"evaluate",
       {"--recording absent.csv --mesh mesh.obj --model model.json",
        "--recording bad.csv --mesh mesh.obj --model model.json"}},
      {"fit",
       {"--recording absent.csv --mesh mesh.obj --model model.json --parameter stiffness_N_per_m=1:9",
        "--recording bad.csv --mesh mesh.obj --model model.json --parameter stiffness_N_per_m=1:9"}},
      {"golden new",
       {"--golden made mine --mesh absent.obj --trajectory good.csv --model model.json",
        "--golden made mine --mesh mesh.obj --trajectory bad.csv --model model.json"}},
      {"golden review", {"", ""}},
      {"golden accept", {"--golden absent --reason why", "--golden bad-golden --reason why"}},
      {"golden export", {"--golden absent --to to", "--golden bad-golden --to to"}},
      {"golden render", {"--golden absent --to to", "--golden bad-golden --to to"}},
      {"golden floor", {"--golden absent", "--golden bad-golden"}},
      {"hil record", {"ati-netft --map absent.json", "ati-netft --map bad.json"}},
      {"hil recover", {"absent.tsraw", "bad.csv"}},
      {"hil render",
       {"--device novint-falcon --map absent.json --model model.json --mesh mesh.obj --force-limit 1",
        "--device novint-falcon --map bad.json --model bad.json --mesh mesh.obj --force-limit 1"}},
      {"hil report", {"absent", "bad.csv"}},
      {"import", {"absent.txt --map absent.json", "bad.csv --map bad.json"}},
      {"leaderboard", {"--dataset absent", "--dataset bad-golden"}},
      {"loop",
       {"--model absent.json --mesh mesh.obj --path good.csv", "--model model.json --mesh mesh.obj --path bad.csv"}},
      {"loop atlas", {"--device absent", "--device bad.json"}},
      {"loop fit", {"--recording absent.csv", "--recording bad.csv"}},
      {"loop width", {"--device absent", "--device bad.json"}},
      {"perceive", {"--real absent.csv --condition a=good.csv", "--real good.csv --condition a=bad.csv"}},
      {"replay",
       {"--model absent.json --mesh mesh.obj --trajectory good.csv",
        "--model model.json --mesh mesh.obj --trajectory bad.csv"}},
      {"scorecard", {"--plugin absent.so", "--renderer god-object --shape absent"}},
      {"sweep", {"absent.json", "bad.json"}},
      {"synth", {"", "--dataset nonsense"}},
      {"texture fit", {"absent.csv", "bad.csv"}},
      {"texture plugin", {"absent.xml", "bad.json"}},
      {"tool case", {"", "nonsense"}},
      {"tool replay", {tool + "mesh.obj --path absent.csv", tool + "mesh.obj --path bad.csv"}},
      {"tool table", {"", "nonsense"}},
      {"tool atlas", {"--merge absent.sqlite", "--merge bad.csv"}},
      {"tool sweep", {"absent.json", "bad.json"}},
      {"tool fit", {tool + "mesh.obj absent.csv", tool + "mesh.obj bad.csv"}},
      {"tool golden", {"absent.json", "bad.json"}},
      {"tool scorecard", {"--case nonsense", "--renderer nonsense"}},
      {"blind make", {"", "--share 7"}},
      {"blind run", {"--cases absent", "--cases bad-golden"}},
      {"blind follow",
       {"--answers absent.json --cases absent --results absent", "--answers bad.json --cases . --results bad.csv"}},
      {"experiment springs", {"--merge absent.sqlite", "--merge bad.csv"}},
      {"experiment palpation", {"--recording absent.csv", "--recording bad.csv"}},
      {"experiment indentation", {"--curve absent.csv", "--curve bad.csv"}},
      {"experiment perception", {"", "--seeds 0"}},
      {"experiment voxel", {"--merge absent.sqlite", "--merge bad.csv"}},
      {"experiment cost", {"", "--triangles 0"}},
      {"experiment density", {"--merge absent.sqlite", "--merge bad.csv"}},
      {"experiment shading", {"--merge absent.sqlite", "--merge bad.csv"}},
      {"experiment friction", {"--merge absent.sqlite", "--merge bad.csv"}},
  };
  return all;
}

class FailedRun : public testing::BuiltProgram {
 protected:
  void SetUp() override {
    BuiltProgram::SetUp();
    if (IsSkipped()) return;
    std::string rows = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
    for (int i = 0; i < 100; ++i) rows += fmt::format("{},0.05,{},0,0,0,1\n", 0.001 * i, 0.05 + 0.00001 * i);
    write_file(folder_ / "good.csv", rows);
    write_file(folder_ / "bad.csv", rows + "0.1,nan,0.05,0,0,0,1\n");
    write_file(folder_ / "bad.json", "{\"schema\": ");
    write_file(folder_ / "mesh.obj", "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3\nf 1 3 4\n");
    write_file(folder_ / "model.json", R"({"schema": "touchstone-model/1", "renderer": "god-object"})");
    std::filesystem::create_directories(folder_ / "bad-golden" / "one");
    write_file(folder_ / "bad-golden" / "one" / "case.json", "{\"schema\": ");
    write_file(folder_ / "out.txt", "");
    write_file(folder_ / "err.txt", "");
  }

  [[nodiscard]] std::string tree() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      names.insert(entry.path().lexically_relative(folder_).string());
    return fmt::format("{}", fmt::join(names, "\n"));
  }

  // Those that take --out, below `words`, from the program's help.
  void commands_with_out(const std::string& words, std::set<std::string>& found) const {
    const Outcome help = run(words + " --help");
    std::istringstream lines(help.out);
    bool below = false;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("  --out ")) found.insert(words);
      if (line.starts_with("Subcommands:") || line.empty()) below = line.starts_with("Subcommands:");
      if (!below || line.size() < 4 || !line.starts_with("  ") || line[2] == ' ') continue;
      const std::string name = line.substr(2, line.find(' ', 2) - 2);
      commands_with_out(words.empty() ? name : words + " " + name, found);
    }
  }
};

TEST_F(FailedRun, EveryCommandWithOutIsInTheTable) {
  std::set<std::string> found;
  commands_with_out("", found);
  // "Extras: acquire (its path), atlas (...", the last words of the help.
  std::istringstream extras(run("--help").out);
  for (std::string line; std::getline(extras, line);) {
    if (!line.starts_with("Extras: ")) continue;
    for (std::size_t at = 7, end = 0; (end = line.find(" (", at)) != std::string::npos; at = line.find(')', end) + 2)
      commands_with_out(line.substr(at + 1, end - at - 1), found);
  }
  EXPECT_GT(found.size(), 40U);
  for (const std::string& words : found) EXPECT_TRUE(failing_commands().contains(words)) << words;
  for (const auto& [words, unused] : failing_commands()) EXPECT_TRUE(found.contains(words)) << words;
}

TEST_F(FailedRun, LeavesTheTreeAsItWas) {
  const std::string before = tree();
  for (const auto& [words, failing] : failing_commands()) {
    const std::string out = " --out new/folder/out";
    // With the default of --out, too.
    for (const std::string& arguments :
         {failing.missing + out, failing.bad + out, failing.bad, failing.bad + out + " --no-such-option 1"}) {
      if (arguments == out || arguments.empty()) continue;  // nothing to read
      const std::string all = words + " " + arguments;
      SCOPED_TRACE(all);
      for (const char* const made : {"new", "made", "to"}) std::filesystem::remove_all(folder_ / made);
      const Outcome ran = run(all);
      EXPECT_TRUE(ran.status == 2 || ran.status == 3) << ran.status << ": " << ran.err;
      EXPECT_EQ(tree(), before);
    }
  }
}

}  // namespace
}  // namespace touchstone::apps
