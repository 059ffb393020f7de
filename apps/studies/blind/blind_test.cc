// A small fixed part of the blind test on every commit: made, searched and scored by the program as a user would.
#include <fstream>

#include "harness/pipeline/discrepancy/sample_check.h"

namespace touchstone::blind {
namespace {

using pipeline::DiscrepancySamples;

class Blind : public DiscrepancySamples {
 protected:
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
