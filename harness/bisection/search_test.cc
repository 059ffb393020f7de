// The search on simulated histories whose causes are known: steps, drifts, both, noise, broken commits. The builds are
// held against a plan that is told what kind of change there is and only has to find where.
#include "harness/bisection/search.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <string>

#include "harness/base/random.h"

namespace touchstone::bisection {
namespace {

struct History {
  std::string kind;
  std::vector<double> truth;  // the metric of each commit
  std::vector<bool> broken;
  double noise = 0.0;
  std::set<std::size_t> culprits;  // positions with a step
  double drift = 0.0;              // of the whole change
};

struct Outcome {
  SearchFindings found;
  std::size_t builds = 0;
  std::size_t runs = 0;
};

Outcome search(const History& history, Random& random, SearchOptions options = {}) {
  CommitCurve curve(history.truth.size());
  Outcome outcome;
  std::set<std::size_t> built;
  for (auto requests = next_requests(curve, options); !requests.empty(); requests = next_requests(curve, options)) {
    for (const MeasureRequest& request : requests) {
      built.insert(request.position);
      if (history.broken[request.position]) {
        curve.set_broken(request.position);
        continue;
      }
      for (std::size_t i = 0; i < request.runs; ++i)
        curve.add_run(request.position, history.truth[request.position] + history.noise * random.normal());
      outcome.runs += request.runs;
    }
    if (built.size() > history.truth.size()) ADD_FAILURE() << "no end";
  }
  outcome.found = conclude(curve, options);
  outcome.builds = built.size();
  return outcome;
}

// Binary search without noise by one who knows the steps: an interval is divided while a step is in it and it can be.
// Broken commits cost it what they cost the search, a build each. To say of a drift that no commit holds more than a
// seventh of it takes six measurements inside, whoever makes them; those that find a step may be among them.
std::size_t builds_of_best_plan(const History& history) {
  CommitCurve curve(history.truth.size());
  History steps = history;
  double level = 0.0;
  for (std::size_t i = 0; i < steps.truth.size(); ++i) {
    if (history.culprits.contains(i)) level += 1.0;
    steps.truth[i] = level;
  }
  steps.noise = 0.0;
  Random unused(1);
  const std::size_t for_drift = history.drift > 0.0 ? 8 : 2;
  if (history.culprits.empty()) return for_drift;
  return std::max(for_drift, search(steps, unused, {.least_share = 1e-6}).builds);
}

// Rows of one to four commits; not beside a culprit, where nobody could tell which commit it was.
void break_some(History& history, Random& random) {
  const std::size_t commits = history.truth.size();
  for (int row = 0; row < 3; ++row) {
    const std::size_t first = 1 + random.below(commits - 1);
    for (std::size_t i = first; i < std::min(commits - 1, first + 1 + random.below(4)); ++i) {
      if (!history.culprits.contains(i) && !history.culprits.contains(i + 1)) history.broken[i] = true;
    }
  }
}

History make_history(std::size_t number, Random& random) {
  History history;
  const std::size_t commits = 16 + random.below(185);
  history.truth.assign(commits, 0.0);
  history.broken.assign(commits, false);
  const std::size_t kind = number % 10;
  const auto place = [&] { return 1 + random.below(commits - 1); };
  const auto add_steps = [&](std::size_t count) {
    while (history.culprits.size() < count) history.culprits.insert(place());
    for (const std::size_t at : history.culprits) {
      const double size = 1.0 + random.uniform();
      for (std::size_t i = at; i < commits; ++i) history.truth[i] += size;
    }
  };
  // Each commit by about the same; over all, or over a part.
  const auto add_drift = [&](double size, bool whole) {
    const std::size_t length = whole ? commits - 1 : std::max<std::size_t>(14, (commits - 1) * 2 / 3);
    const std::size_t first = whole ? 0 : random.below(commits - length);
    double sum = 0.0;
    for (std::size_t i = 1; i < commits; ++i) {
      if (i > first && i <= first + length) sum += size / static_cast<double>(length) * (0.7 + 0.6 * random.uniform());
      history.truth[i] += sum;
    }
  };
  switch (kind) {
    case 0:
      history.kind = "one step";
      add_steps(1);
      break;
    case 1:
      history.kind = "two or three steps";
      add_steps(2 + random.below(2));
      break;
    case 2:
      history.kind = "drift";
      add_drift(1.0, true);
      break;
    case 3:
      history.kind = "drift of a part";
      add_drift(1.0, false);
      break;
    case 4:
      history.kind = "step in a drift";
      add_steps(1);
      add_drift(1.0 + random.uniform(), true);
      break;
    case 5:
      history.kind = "noisy steps";
      add_steps(1 + random.below(2));
      break;
    case 6:
      history.kind = "noisy drift";
      add_drift(1.0, true);
      break;
    case 7:
      history.kind = "noisy step in a drift";
      add_steps(1);
      add_drift(1.0 + random.uniform(), true);
      break;
    case 8:
      history.kind = "steps among broken commits";
      add_steps(1 + random.below(2));
      break;
    default:
      history.kind = "noisy step among broken commits";
      add_steps(1);
      break;
  }
  const double whole = history.truth.back();
  if (kind == 2 || kind == 3 || kind == 6) history.drift = 1.0;
  if (kind == 4 || kind == 7) {
    double steps = 0.0;
    for (const std::size_t at : history.culprits) steps += history.truth[at] - history.truth[at - 1];
    history.drift = 1.0 - steps / whole;
  }
  // Of one run: from hardly any to a seventh of the whole change.
  if (kind >= 5 && kind != 8) history.noise = whole * (0.01 + 0.14 * random.uniform());
  if (kind >= 8) break_some(history, random);
  for (double& value : history.truth) value += 10.0;
  return history;
}

TEST(BisectSearch, OnTwoHundredHistoriesNamesTheCulpritsAndNoInnocent) {
  constexpr std::size_t histories = 200;
  // Another seed: TOUCHSTONE_BISECTION_SEED.
  const char* const given = std::getenv("TOUCHSTONE_BISECTION_SEED");
  Random random(given == nullptr ? 20 : std::strtoull(given, nullptr, 10));
  std::size_t culprits = 0;
  std::size_t named = 0;
  std::size_t sure = 0;
  std::size_t innocents = 0;
  std::size_t builds = 0;
  std::size_t best = 0;
  std::size_t drifts = 0;
  std::size_t drifts_found = 0;
  std::map<std::string, std::array<std::size_t, 7>> table;
  for (std::size_t i = 0; i < histories; ++i) {
    const History history = make_history(i, random);
    const Outcome outcome = search(history, random);
    auto& row = table[history.kind];
    std::set<std::size_t> right;
    for (const Step& step : outcome.found.steps) {
      if (step.single() && history.culprits.contains(step.at)) right.insert(step.at);
      if (!step.sure()) continue;
      ++sure;
      if (!history.culprits.contains(step.at)) {
        ++innocents;
        ++row[3];
      }
    }
    culprits += history.culprits.size();
    named += right.size();
    builds += outcome.builds;
    const std::size_t plan = builds_of_best_plan(history);
    best += plan;
    row[0] += 1;
    row[1] += history.culprits.size();
    row[2] += right.size();
    row[4] += outcome.builds;
    row[5] += plan;
    row[6] += outcome.runs;
    if (history.drift > 0.0) {
      ++drifts;
      double share = 0.0;
      for (const Drift& drift : outcome.found.drifts) share += drift.share;
      drifts_found += std::abs(share - history.drift) < 0.25 ? 1 : 0;
    }
  }
  fmt::print("{:34} {:>9} {:>8} {:>5} {:>9} {:>6} {:>9} {:>6}\n", "kind", "histories", "culprits", "right", "innocents",
             "builds", "best plan", "runs");
  for (const auto& [kind, row] : table)
    fmt::print("{:34} {:>9} {:>8} {:>5} {:>9} {:>6} {:>9} {:>6}\n", kind, row[0], row[1], row[2], row[3], row[4],
               row[5], row[6]);
  fmt::print(
      "culprits {}, named {}; named with high confidence {}, of them innocent {}; builds {}, best plan {}; "
      "drifts {}, said so {}\n",
      culprits, named, sure, innocents, builds, best, drifts, drifts_found);
  EXPECT_GE(static_cast<double>(named), 0.95 * static_cast<double>(culprits));
  EXPECT_LE(static_cast<double>(innocents), 0.01 * static_cast<double>(sure));
  EXPECT_LE(static_cast<double>(builds), 1.5 * static_cast<double>(best));
  for (const auto& [kind, row] : table)
    EXPECT_LE(static_cast<double>(row[4]), 1.5 * static_cast<double>(row[5])) << kind;
  EXPECT_GE(static_cast<double>(drifts_found), 0.95 * static_cast<double>(drifts));
}

History quiet(std::vector<double> truth) {
  History history;
  history.broken.assign(truth.size(), false);
  history.truth = std::move(truth);
  return history;
}

TEST(BisectSearch, TwentyThreeSmallRisesAreDriftAndNobodysFault) {
  std::vector<double> truth{1.0};
  for (int i = 0; i < 23; ++i) truth.push_back(truth.back() * 1.003);
  Random random(1);
  const Outcome outcome = search(quiet(truth), random);
  EXPECT_TRUE(outcome.found.steps.empty());
  ASSERT_EQ(outcome.found.drifts.size(), 1U);
  EXPECT_EQ(outcome.found.drifts[0].first, 0U);
  EXPECT_EQ(outcome.found.drifts[0].last, 23U);
  EXPECT_NEAR(outcome.found.drifts[0].share, 1.0, 1e-9);
  EXPECT_LE(outcome.builds, 9U);
}

TEST(BisectSearch, AStepInsideADriftIsTheStep) {
  for (std::size_t at = 1; at <= 23; ++at) {
    std::vector<double> truth{1.0};
    for (std::size_t i = 1; i <= 23; ++i) truth.push_back(truth.back() * (i == at ? 1.013 : 1.003));
    Random random(1);
    const Outcome outcome = search(quiet(truth), random);
    ASSERT_EQ(outcome.found.steps.size(), 1U) << at;
    EXPECT_EQ(outcome.found.steps[0].at, at);
    EXPECT_TRUE(outcome.found.steps[0].sure());
    EXPECT_NEAR(outcome.found.steps[0].excess, 0.0101, 0.0015);
    double drift = 0.0;
    for (const Drift& one : outcome.found.drifts) drift += one.share;
    EXPECT_NEAR(drift, 1.0 - 0.01 * 1.03 / (truth.back() - 1.0), 0.05) << at;
    EXPECT_LE(outcome.builds, 13U);
  }
}

TEST(BisectSearch, BothOfTwoFaultsAreNamedWithTheirShares) {
  std::vector<double> truth(64, 1.0);
  for (std::size_t i = 20; i < 64; ++i) truth[i] += 0.2;
  for (std::size_t i = 47; i < 64; ++i) truth[i] += 0.05;
  Random random(1);
  const Outcome outcome = search(quiet(truth), random);
  ASSERT_EQ(outcome.found.steps.size(), 2U);
  EXPECT_EQ(outcome.found.steps[0].at, 20U);
  EXPECT_NEAR(outcome.found.steps[0].share, 0.8, 1e-9);
  EXPECT_EQ(outcome.found.steps[1].at, 47U);
  EXPECT_NEAR(outcome.found.steps[1].share, 0.2, 1e-9);
  EXPECT_NEAR(outcome.found.unexplained_share, 0.0, 1e-9);
}

// A rise and a fall: the two add up to the whole, one with a share above 1.
TEST(BisectSearch, StepsAgainstEachOther) {
  std::vector<double> truth(64, 1.0);
  for (std::size_t i = 10; i < 64; ++i) truth[i] += 0.3;
  for (std::size_t i = 40; i < 64; ++i) truth[i] -= 0.1;
  Random random(1);
  const Outcome outcome = search(quiet(truth), random);
  ASSERT_EQ(outcome.found.steps.size(), 2U);
  EXPECT_NEAR(outcome.found.steps[0].share, 1.5, 1e-9);
  EXPECT_NEAR(outcome.found.steps[1].share, -0.5, 1e-9);
}

TEST(BisectSearch, BehindBrokenCommitsNobodyIsNamedAlone) {
  History history = quiet(std::vector<double>(64, 1.0));
  for (std::size_t i = 33; i < 64; ++i) history.truth[i] = 1.2;
  for (const std::size_t i : {31U, 32U, 33U, 34U}) history.broken[i] = true;
  Random random(1);
  const Outcome outcome = search(history, random);
  ASSERT_EQ(outcome.found.steps.size(), 1U);
  EXPECT_EQ(outcome.found.steps[0].before, 30U);
  EXPECT_EQ(outcome.found.steps[0].at, 35U);
  EXPECT_FALSE(outcome.found.steps[0].sure());
}

// Where nothing changed, nothing is searched, and noise names nobody.
TEST(BisectSearch, PureNoiseNamesNobody) {
  Random random(3);
  std::size_t named = 0;
  for (int i = 0; i < 200; ++i) {
    History history = quiet(std::vector<double>(64, 1.0));
    history.noise = 0.02;
    const Outcome outcome = search(history, random);
    for (const Step& step : outcome.found.steps) named += step.sure() ? 1 : 0;
  }
  EXPECT_LE(named, 2U);
  EXPECT_FALSE(search(quiet(std::vector<double>(9, 1.0)), random).found.ends_differ);
}

// Several workers: the same answer, in fewer rounds.
TEST(BisectSearch, ParallelBuildsFindTheSame) {
  std::vector<double> truth(200, 1.0);
  for (std::size_t i = 77; i < 200; ++i) truth[i] = 1.1;
  Random random(1);
  const Outcome outcome = search(quiet(truth), random, {.parallel = 4});
  ASSERT_EQ(outcome.found.steps.size(), 1U);
  EXPECT_EQ(outcome.found.steps[0].at, 77U);
}

}  // namespace
}  // namespace touchstone::bisection
