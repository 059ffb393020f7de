#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "renderers/catalogue.h"
#include "sweep/sweep_cases.h"
#include "synthetic/generators.h"

namespace touchstone::sweep {
using runs::CaseStore;
using runs::CaseTally;
using runs::SweepCase;
using runs::SweepDesign;

namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::atomic<bool> never = false;

class Sweep : public testing::Test {
 protected:
  Sweep() { std::filesystem::create_directories(folder_); }
  ~Sweep() override { std::filesystem::remove_all(folder_); }

  static json grid() {
    return json::parse(R"({"schema": "touchstone-sweep/1", "design": "grid",
      "surfaces": {"ball": {"name": "sphere", "parameters": {"radius_m": 0.03}, "triangles": 500},
                   "floor": {"name": "plane", "triangles": 50}},
      "trajectories": {"tap": {"name": "taps", "parameters": {"taps": 1, "period_s": 0.1}}},
      "models": {"god": {"schema": "touchstone-model/1", "renderer": "god-object", "parameters": {}},
                 "spring": {"schema": "touchstone-model/1", "renderer": "spring-linear", "parameters": {}}},
      "vary": [{"set": "/model/parameters/stiffness_N_per_m", "values": [300, 600, 900]},
               {"set": "/scale", "from": 0.01, "to": 100, "count": 3, "spacing": "log"}],
      "seeds": [1, 2]})");
  }
  static json hypercube(std::size_t cases) {
    json spec = grid();
    spec["design"] = "latin-hypercube";
    spec["cases"] = cases;
    spec["vary"] = json::parse(R"([{"set": "/model/parameters/stiffness_N_per_m", "from": 100, "to": 1000},
                                   {"set": "/scale", "from": 0.01, "to": 100, "spacing": "log"}])");
    return spec;
  }
  std::filesystem::path write(const json& spec, const char* name = "spec.json") const {
    write_file(folder_ / name, spec.dump());
    return folder_ / name;
  }
  std::filesystem::path out(const std::string& name) const { return folder_ / name; }

  static CaseTally run(const SweepDesign& design, CaseStore& store, runs::CaseShard shard, unsigned threads) {
    SweepWorld world({renderers::built_in_catalogue(), synthetic::built_in_generators()}, design);
    return run_cases(sweep_job(design, world), store, shard, threads, never);
  }
  // Everything on `threads` threads into a new file; its content hash.
  std::string run_all(const SweepDesign& design, const std::string& name, unsigned threads) const {
    CaseStore store(out(name), sweep_table(design));
    store.start_run({{"command", name}});
    run(design, store, {}, threads);
    return store.content_hash();
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("touchstone-sweep-" + std::to_string(::getpid()));
};

TEST_F(Sweep, AGridNumbersEveryCombinationOnce) {
  const SweepDesign design(write(grid()), sweep_parts());
  EXPECT_EQ(design.size(), 2U * 1U * 2U * 3U * 3U * 2U);
  std::set<std::string> documents;
  for (std::uint64_t n = 0; n < design.size(); ++n) documents.insert(design.at(n).document);
  EXPECT_EQ(documents.size(), design.size());
  const SweepCase last = design.at(design.size() - 1);
  EXPECT_EQ(last.chosen.front(), "floor");
  EXPECT_EQ(last.chosen.back(), "spring");
  EXPECT_EQ(last.seed, 2U);
  EXPECT_EQ(last.varied, (std::vector<double>{900.0, 100.0}));
  EXPECT_NEAR(design.at(2).varied[1], 1.0, 1e-15);
}

TEST_F(Sweep, AHypercubeHasEachStratumOfEachAxisOnce) {
  for (const std::size_t cases : {1U, 7U, 1000U}) {
    const SweepDesign design(write(hypercube(cases)), sweep_parts());
    std::set<int> stiffness;
    std::set<int> scale;
    std::map<std::string, std::size_t> surfaces;
    for (std::uint64_t n = 0; n < design.size(); ++n) {
      const SweepCase one = design.at(n);
      stiffness.insert(static_cast<int>((one.varied[0] - 100.0) / 900.0 * static_cast<double>(cases)));
      scale.insert(static_cast<int>((std::log10(one.varied[1]) + 2.0) / 4.0 * static_cast<double>(cases)));
      ++surfaces[one.chosen.front()];
      EXPECT_EQ(one.document, design.at(n).document);
    }
    EXPECT_EQ(stiffness.size(), cases);
    EXPECT_EQ(scale.size(), cases);
    if (cases > 2) {
      EXPECT_LE(std::max(surfaces["ball"], surfaces["floor"]), (cases + 1) / 2);
    }
  }
}

TEST_F(Sweep, ResultsDoNotDependOnThreadsOrShardsToTheBit) {
  const SweepDesign design(write(hypercube(60)), sweep_parts());
  const std::string alone = run_all(design, "one.sqlite", 1);
  EXPECT_EQ(run_all(design, "four.sqlite", 4), alone);
  CaseStore merged(out("merged.sqlite"), sweep_table(design));
  for (const std::uint64_t k : {3U, 1U, 2U}) {
    {
      CaseStore part(out("part" + std::to_string(k)), sweep_table(design));
      part.start_run({});
      run(design, part, {k, 3}, 2);
    }
    EXPECT_EQ(merged.merge(out("part" + std::to_string(k))).added, 20U);
    EXPECT_EQ(merged.merge(out("part" + std::to_string(k))).repeated, 20U);
  }
  EXPECT_EQ(merged.content_hash(), alone);
  EXPECT_EQ(merged.done().size(), 60U);
}

// A sweep that is killed in the middle, again and again, ends with the rows of one that was not.
TEST_F(Sweep, GoesOnAfterKillWithoutCountingTwice) {
  const SweepDesign design(write(hypercube(1500)), sweep_parts());
  const auto file = out("killed.sqlite");
  std::uint64_t before = 0;
  int kills = 0;
  for (int round = 0; round < 2; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      CaseStore store(file, sweep_table(design));
      store.start_run({});
      run(design, store, {}, 1);
      _exit(0);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1600));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    kills += WIFSIGNALED(status) ? 1 : 0;
    const CaseStore store(file, sweep_table(design));
    EXPECT_GE(store.done().size(), before);
    before = store.done().size();
  }
  std::string whole;
  {
    CaseStore store(file, sweep_table(design));
    store.start_run({});
    const CaseTally tally = run(design, store, {}, 2);
    EXPECT_EQ(tally.before, before);
    EXPECT_EQ(tally.ran, 1500U - before);
    EXPECT_EQ(store.done().size(), 1500U);
    EXPECT_EQ(store.failed(), 0U);
    whole = store.content_hash();
    EXPECT_EQ(run(design, store, {}, 2).ran, 0U);
  }
  fmt::print("killed {} times, {} cases kept until then\n", kills, before);
  EXPECT_EQ(run_all(design, "unharmed.sqlite", 2), whole);
}

TEST_F(Sweep, ACaseThatFailsIsARowWithItsError) {
  json spec = grid();
  spec["vary"][0]["values"] = {300, -1};
  spec["surfaces"]["nothing"] = {{"name", "no-such-shape"}, {"triangles", 10}};
  const SweepDesign design(write(spec), sweep_parts());
  CaseStore store(out("failing.sqlite"), sweep_table(design));
  store.start_run({});
  const CaseTally tally = run(design, store, {}, 2);
  EXPECT_EQ(tally.ran, design.size());
  EXPECT_EQ(tally.failed,
            design.size() / 3 + design.size() / 3);  // one surface of three, one stiffness of the rest's two
  EXPECT_EQ(store.failed(), tally.failed);
  store.write_csv(out("failing.csv"));
  const std::string csv = read_file(out("failing.csv"));
  EXPECT_THAT(csv, HasSubstr("no-such-shape"));
  EXPECT_THAT(csv, HasSubstr("stiffness_N_per_m"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), static_cast<std::ptrdiff_t>(design.size() + 1));
  store.forget_failed();
  EXPECT_EQ(run(design, store, {}, 2).ran, tally.failed);
}

TEST_F(Sweep, TheExactAnswerIsNearOnAFineMeshAndScalesWithTheWorld) {
  json spec = grid();
  spec["truth"] = true;
  spec["surfaces"].erase("floor");
  spec["surfaces"]["ball"]["triangles"] = 20000;
  spec["vary"] = {{{"set", "/scale"}, {"values", {0.001, 1.0, 1000.0}}}};
  spec["trajectories"]["tap"]["offset_m"] = {0.0, 0.0, 0.03};
  const SweepDesign design(write(spec), sweep_parts());
  SweepWorld world({renderers::built_in_catalogue(), synthetic::built_in_generators()}, design);
  for (std::uint64_t n = 0; n < design.size(); ++n) {
    const SweepOutcome outcome = world.run(n);
    ASSERT_EQ(outcome.error, "");
    ASSERT_TRUE(outcome.exact.has_value());
    EXPECT_GT(outcome.summary.peak_force_N, 0.0);
    EXPECT_GT(outcome.exact->force_rms_N, 0.0);
    // Facets of 1.2 mm on a ball of 30 mm turn the normal by up to 0.023 rad.
    EXPECT_LT(outcome.exact->force_max_N, 0.03 * outcome.summary.peak_force_N);
  }
  EXPECT_EQ(world.surfaces_made(), 3U);  // one for each scale
}

TEST_F(Sweep, AForeignFileIsRefusedAndLeftAsItIs) {
  const SweepDesign design(write(grid()), sweep_parts());
  write_file(out("notes.txt"), "my notes, longer than the head of a database, so that nothing could take them for one");
  EXPECT_THROW(CaseStore(out("notes.txt"), sweep_table(design)), BadData);
  EXPECT_THAT(read_file(out("notes.txt")), testing::StartsWith("my notes"));
  { const CaseStore first(out("first.sqlite"), sweep_table(design)); }
  json other = grid();
  other["seeds"] = {1};
  const SweepDesign another(write(other, "other.json"), sweep_parts());
  EXPECT_THROW(CaseStore(out("first.sqlite"), sweep_table(another)), BadData);
  const CaseStore writing(out("first.sqlite"), sweep_table(design));
  EXPECT_THROW(CaseStore(out("first.sqlite"), sweep_table(design)), BadData);
}

TEST_F(Sweep, PartsThatDisagreeAreNotMerged) {
  const SweepDesign design(write(hypercube(5)), sweep_parts());
  run_all(design, "a.sqlite", 1);
  run_all(design, "b.sqlite", 1);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(out("b.sqlite").c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, "UPDATE cases SET peak_force_N = peak_force_N + 1e-12 WHERE case_number = 3",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  CaseStore store(out("a.sqlite"), sweep_table(design));
  EXPECT_THROW(store.merge(out("b.sqlite")), BadData);
  EXPECT_THROW(store.merge(out("absent.sqlite")), BadData);
}

TEST_F(Sweep, AMergedCaseStandsForOneThatFailed) {
  const SweepDesign design(write(hypercube(5)), sweep_parts());
  run_all(design, "whole.sqlite", 1);
  run_all(design, "gaps.sqlite", 1);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(out("gaps.sqlite").c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, "DELETE FROM cases WHERE case_number IN (1, 3)", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  CaseStore store(out("gaps.sqlite"), sweep_table(design));
  store.start_run({});
  const runs::CaseRow failed{3, "disk", {}};
  store.add({&failed, 1});
  EXPECT_EQ(store.failed(), 1U);
  const runs::CaseMerge merged = store.merge(out("whole.sqlite"));
  EXPECT_EQ(merged.added, 2U);
  EXPECT_EQ(merged.repeated, 4U);
  EXPECT_EQ(store.failed(), 0U);
  EXPECT_EQ(store.content_hash(), CaseStore(out("whole.sqlite"), sweep_table(design)).content_hash());
}

struct BadSpecification {
  const char* name;
  const char* pointer;
  json value;  // null: removed
  const char* said;
};
void PrintTo(const BadSpecification& bad, std::ostream* out) { *out << bad.name; }
class Refused : public Sweep, public testing::WithParamInterface<BadSpecification> {};

TEST_P(Refused, WithItsPlace) {
  json spec = grid();
  const json::json_pointer at(GetParam().pointer);
  if (GetParam().value.is_null()) {
    spec[at.parent_pointer()].erase(at.back());
  } else {
    spec[at] = GetParam().value;
  }
  try {
    const SweepDesign design(write(spec), sweep_parts());
    FAIL() << "was taken";
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr(GetParam().said));
    EXPECT_THAT(error.what(), HasSubstr("spec.json"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Specifications, Refused,
    testing::Values(BadSpecification{"NoSurface", "/surfaces", nullptr, "surfaces"},
                    BadSpecification{"NoModel", "/models", json::object(), "at least one"},
                    BadSpecification{"NoTrajectoryButItsName", "/trajectories/tap", "taps", "object {...}"},
                    BadSpecification{"Misspelt", "/modles", 1, "modles"},
                    BadSpecification{"UnknownDesign", "/design", "random", "latin-hypercube"},
                    BadSpecification{"PointsNowhere", "/vary/0/set", "/renderer", "no part of a case"},
                    BadSpecification{"TwiceTheSame", "/vary/1/set", "/model/parameters/stiffness_N_per_m", "twice"},
                    BadSpecification{"EmptyRange", "/vary/1/to", 0.01, "from"},
                    BadSpecification{"LogFromZero", "/vary/1/from", 0.0, "log"},
                    BadSpecification{"OneStep", "/vary/1/count", 1, "2 or more"},
                    BadSpecification{"HalfASeed", "/seeds", json::array({0.5}), "whole number"},
                    BadSpecification{"TooMany", "/vary/1/count", 5000000, "whole number"}),
    [](const auto& bad) { return std::string(bad.param.name); });

}  // namespace
}  // namespace touchstone::sweep
