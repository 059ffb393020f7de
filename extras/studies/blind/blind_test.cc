// A small fixed part of the blind test on every commit: made, searched and scored by the program as a user would.
#include <fstream>
#include <nlohmann/json.hpp>

#include "harness/testing/built_program.h"

namespace touchstone::blind {
namespace {

class Blind : public testing::BuiltProgram {
 protected:
  int run(const std::string& arguments) const { return testing::BuiltProgram::run(arguments).status; }
  // Makes, searches and scores the second case of the sets, which are cheap: a tool's weight, a mesh that is off within
  // its declared error, friction that pulls along. What `score` wrote.
  nlohmann::json blind(const std::string& sets, int seed) const {
    const auto place = folder_.string();
    EXPECT_EQ(run(fmt::format("blind make --seed {} {} --first 1 --count 1 --out '{}'", seed, sets, place)), 0)
        << errors();
    EXPECT_EQ(run(fmt::format("blind run --cases '{0}/cases' --out '{0}/found'", place)), 0) << errors();
    score();
    return nlohmann::json::parse(read_file(folder_ / "score.json"));
  }
  // Its exit status; the table is in out.txt.
  int score() const {
    return run(
        fmt::format("blind score --answers '{0}/answers.json' --cases '{0}/cases' --results '{0}/found' --json "
                    "'{0}/score.json'",
                    folder_.string()));
  }
  std::string table() const { return read_file(folder_ / "out.txt"); }
  std::string errors() const { return read_file(folder_ / "err.txt"); }
};

TEST_F(Blind, ASmallPartIsRight) {
  const auto score = blind("--set none --set one --set corrupted", 2026);
  ASSERT_EQ(score.at("cases").size(), 3);
  for (const auto& one : score.at("cases")) {
    EXPECT_TRUE(one.at("right").get<bool>()) << one.dump(1);
    if (one.at("closed").is_null() || one.at("expected").empty()) continue;
    EXPECT_GT(one.at("closed").get<double>(), 0.9) << one.dump(1);
  }
}

// The tasks of a farm, each a shard with rows of its own; the same command afterwards takes them, and writes from the
// rows the findings that lie on other machines.
TEST_F(Blind, TheTasksOfAJobListAreScoredFromTheirRows) {
  const std::string place = folder_.string();
  ASSERT_EQ(run(fmt::format("blind make --seed 2026 --set one --set corrupted --first 1 --count 1 --out '{}'", place)),
            0);
  const std::string ask = fmt::format("blind run --cases '{0}/cases' --out '{0}/found' --engine jobs --tasks 2", place);
  EXPECT_EQ(run(ask), 1) << "nothing is searched yet";
  const auto tasks = folder_ / "found" / "rows.sqlite.parts";
  ASSERT_TRUE(std::filesystem::exists(tasks / "task.sh")) << table();
  EXPECT_EQ(std::system(fmt::format("sh '{}' 1 >/dev/null 2>&1", (tasks / "task.sh").string()).c_str()), 0);
  EXPECT_EQ(run(ask), 1) << "a shard is open";
  EXPECT_THAT(table(), ::testing::HasSubstr("1 of 2 shards are open"));
  EXPECT_EQ(std::system(fmt::format("sh '{}' 2 >/dev/null 2>&1", (tasks / "task.sh").string()).c_str()), 0);
  std::vector<std::string> findings;
  for (const auto& one : std::filesystem::directory_iterator(folder_ / "cases")) {
    const auto folder = folder_ / "found" / one.path().filename();
    findings.push_back(read_file(folder / "findings.json"));
    std::filesystem::remove_all(folder);
  }
  EXPECT_EQ(run(ask), 0) << table();
  std::size_t i = 0;
  for (const auto& one : std::filesystem::directory_iterator(folder_ / "cases"))
    EXPECT_EQ(read_file(folder_ / "found" / one.path().filename() / "findings.json"), findings.at(i++));
  EXPECT_EQ(score(), 0) << table();
}

TEST_F(Blind, AWeightThatIsOffMissesItsBar) {
  using ::testing::ContainsRegex;
  const auto scored = blind("--set one", 2026);
  ASSERT_EQ(scored.at("cases").size(), 1);
  const std::string line = "parameters of weight, bias, [a-z, -]*: [0-9.]+ % \\(bar 2 %\\)  ";
  EXPECT_THAT(table(), ContainsRegex(line + "met"));
  const auto file = folder_ / "found" / scored.at("cases")[0].at("id").get<std::string>() / "findings.json";
  auto findings = nlohmann::json::parse(read_file(file));
  auto& mass = findings.at("effects").at(0).at("parameters").at(0);
  ASSERT_EQ(mass.at("name"), "mass_kg");
  mass["value"] = 1.1 * mass.at("value").get<double>();
  std::ofstream(file) << findings;
  EXPECT_EQ(score(), 1);
  EXPECT_THAT(table(), ContainsRegex(line + "NOT MET"));
}

TEST_F(Blind, WhatIsFlaggedAsUnknownThoughNothingIsMissingIsNotNamed) {
  using ::testing::ContainsRegex;
  const auto scored = blind("--set none", 2026);
  ASSERT_EQ(scored.at("cases").size(), 1);
  EXPECT_THAT(table(), ContainsRegex("nothing named +bar  98 %  100 % .*\n.*said so +100 %"));
  const auto file = folder_ / "found" / scored.at("cases")[0].at("id").get<std::string>() / "findings.json";
  auto findings = nlohmann::json::parse(read_file(file));
  findings["verdict"] = "unexplained";
  std::ofstream(file) << findings;
  EXPECT_EQ(score(), 1);
  EXPECT_THAT(table(), ContainsRegex("nothing named +bar  98 %  100 % .*\n.*said so +0 %"));
  EXPECT_THAT(table(), ContainsRegex("nothing unknown was there +bar at most 5 %  100 % .*NOT MET"));
}

TEST_F(Blind, CasesAreTheSameForTheSameSeedAndTheirAnswersAreSealed) {
  ASSERT_EQ(run(fmt::format("blind make --seed 5 --set none --count 1 --out '{}/a'", folder_.string())), 0);
  const std::string first = read_file(folder_ / "out.txt");
  ASSERT_EQ(run(fmt::format("blind make --seed 5 --set none --count 1 --out '{}/b'", folder_.string())), 0);
  const std::string hash = "SHA-256 ";
  EXPECT_EQ(first.substr(first.find(hash), hash.size() + 64),
            read_file(folder_ / "out.txt").substr(first.find(hash), hash.size() + 64));
  EXPECT_EQ(read_file(folder_ / "a" / "answers.json"), read_file(folder_ / "b" / "answers.json"));
}

}  // namespace
}  // namespace touchstone::blind
