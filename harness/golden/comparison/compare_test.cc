#include "harness/golden/comparison/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "harness/base/random.h"
#include "harness/golden/comparison/comparison_report.h"

namespace touchstone::golden {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// A press of two strokes: contact in the middle of each, forces of about `newton`, positions of about `metre`.
TrajectoryColumns strokes(std::size_t rows, double newton = 1.0, double metre = 0.01) {
  TrajectoryColumns set{"golden", {}};
  for (const char* const name : {"t", "x", "y", "z", "fx", "fy", "fz", "px", "py", "pz", "contact"})
    set.columns.push_back({name, {}});
  for (std::size_t i = 0; i < rows; ++i) {
    const double phase = 4.0 * M_PI * static_cast<double>(i) / static_cast<double>(rows);
    const double depth = std::max(0.0, std::sin(phase) - 0.3);
    const std::array values{0.001 * static_cast<double>(i),
                            metre * std::cos(phase),
                            0.0,
                            -metre * depth,
                            0.2 * newton * depth,
                            0.0,
                            newton * depth,
                            metre * std::cos(phase),
                            0.0,
                            0.0,
                            depth > 0.0 ? 1.0 : 0.0};
    for (std::size_t c = 0; c < values.size(); ++c) set.columns[c].values.push_back(values[c]);
  }
  return set;
}

std::vector<double>& column(TrajectoryColumns& set, std::string_view name) {
  return const_cast<std::vector<double>&>(*set.find(name));
}

Verdict verdict_of(const TrajectoryColumns& golden, const TrajectoryColumns& obtained,
                   const Tolerance& tolerance = default_tolerance()) {
  return compare(golden, obtained, tolerance).verdict;
}

// Rows are looked at many at a time: whatever the row and the length, the one that differs is found, and one that is
// not finite.
TEST(Compare, OneRowThatDiffersIsFoundWhereverItStands) {
  for (const std::size_t rows : {1U, 7U, 8U, 255U, 256U, 257U, 1000U}) {
    const auto golden = strokes(rows);
    for (std::size_t row = 0; row < rows; ++row) {
      auto other = golden;
      column(other, "fy")[row] += 1.0;
      const auto result = compare(golden, other, default_tolerance());
      const GroupResult& force = *result.find("force");
      ASSERT_EQ(result.verdict, Verdict::worse) << row << " of " << rows;
      ASSERT_EQ(result.drift, 1U) << row << " of " << rows;
      ASSERT_EQ(force.worst_row, row) << "of " << rows;
      ASSERT_EQ(force.max, 1.0) << row << " of " << rows;
      ASSERT_EQ(force.p99, rows <= 99 ? 1.0 : 0.0) << row << " of " << rows;
      double peak = 0.0;
      for (std::size_t i = 0; i < rows; ++i)
        peak = std::max(peak, std::hypot(column(other, "fx")[i], golden.find("fy")->at(i), column(other, "fz")[i]));
      ASSERT_NEAR(force.peak, peak, 1e-15) << rows;
      for (const double value : {nan, std::numeric_limits<double>::infinity()}) {
        column(other, "fy")[row] = value;
        const auto refused = compare(golden, other, default_tolerance());
        ASSERT_EQ(refused.verdict, Verdict::invalid) << row << " of " << rows;
        ASSERT_TRUE(refused.bad_data);
      }
    }
  }
}

// Errors of 1, 2, ..., n mN in some order: the smallest that at least 99 % of the samples do not exceed (nearest rank,
// Hyndman and Fan 1996, definition 1), whatever the length.
TEST(Compare, TheNinetyNinthPercentileIsThatOfTheNearestRank) {
  for (const std::size_t rows : {50U, 99U, 100U, 101U, 150U, 200U, 1000U}) {
    TrajectoryColumns golden{"golden", {{"t", {}}, {"fz", {}}}};
    auto obtained = golden;
    for (std::size_t i = 0; i < rows; ++i) {
      for (auto* const side : {&golden, &obtained}) {
        side->columns[0].values.push_back(0.001 * static_cast<double>(i));
        side->columns[1].values.push_back(0.0);
      }
      obtained.columns[1].values.back() = 1e-3 * static_cast<double>((7 * i) % rows + 1);
    }
    std::size_t rank = 1;
    while (100 * rank < 99 * rows) ++rank;
    const auto result = compare(golden, obtained, default_tolerance());
    EXPECT_DOUBLE_EQ(result.find("force")->p99, 1e-3 * static_cast<double>(rank)) << rows;
    EXPECT_DOUBLE_EQ(result.find("force")->max, 1e-3 * static_cast<double>(rows)) << rows;
  }
}

TEST(Compare, IdenticalIsEqualWithoutDriftAndUsesNothingOfTheTolerance) {
  const auto golden = strokes(1000);
  const auto result = compare(golden, golden, default_tolerance());
  EXPECT_EQ(result.verdict, Verdict::equal);
  EXPECT_EQ(result.drift, 0U);
  EXPECT_EQ(result.tolerance_used(), 0.0);
  EXPECT_EQ(result.events.expected, 4U);
  EXPECT_EQ(result.events.max_shift_s, 0.0);
}

TEST(Compare, OneBitIsDriftAndStillAccurate) {
  const auto golden = strokes(1000);
  auto obtained = golden;
  auto& fz = column(obtained, "fz");
  fz[100] = std::nextafter(fz[100], 10.0);
  fz[101] = std::nextafter(fz[101], 10.0);
  column(obtained, "y")[7] = -0.0;  // the same number, another bit
  const auto result = compare(golden, obtained, default_tolerance());
  EXPECT_EQ(result.verdict, Verdict::equal);
  EXPECT_EQ(result.drift, 3U);
  EXPECT_GT(result.tolerance_used(), 0.0);
  EXPECT_LT(result.tolerance_used(), 1e-6);
}

// Every way in which existing comparison tools were seen to pass what they should not, and more of the kind.
struct Mutation {
  const char* name;
  Verdict expected;
  std::function<void(TrajectoryColumns& golden, TrajectoryColumns& obtained)> plant;
};

void PrintTo(const Mutation& mutation, std::ostream* out) { *out << mutation.name; }

class PlantedMutation : public testing::TestWithParam<Mutation> {};

TEST_P(PlantedMutation, DoesNotPassAtAnyScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    auto golden = strokes(2000, scale, 0.01 * scale);
    auto obtained = golden;
    GetParam().plant(golden, obtained);
    auto tolerance = default_tolerance();
    for (const char* const group : {"force", "position", "contact_position"}) tolerance.groups[group].atol *= scale;
    const auto result = compare(golden, obtained, tolerance);
    EXPECT_EQ(result.verdict, GetParam().expected) << "at scale " << scale << "\n" << to_table(result);
    EXPECT_FALSE(passes(result.verdict));
    EXPECT_GT(result.tolerance_used(), 1.0);
  }
  std::printf("| %s | %s |\n", GetParam().name, std::string(to_string(GetParam().expected)).c_str());
}

INSTANTIATE_TEST_SUITE_P(
    Baseline, PlantedMutation,
    testing::Values(
        Mutation{"NanInResult", Verdict::invalid, [](auto&, auto& o) { column(o, "fz")[5] = nan; }},
        Mutation{"NanInGolden", Verdict::invalid, [](auto& g, auto&) { column(g, "fz")[5] = nan; }},
        Mutation{"NanInBoth", Verdict::invalid, [](auto& g, auto& o) { column(g, "fz")[5] = column(o, "fz")[5] = nan; }},
        Mutation{"InfinityInBoth", Verdict::invalid, [](auto& g, auto& o) { column(g, "fz")[5] = column(o, "fz")[5] = INFINITY; }},
        Mutation{"EveryValueNan", Verdict::invalid, [](auto&, auto& o) { for (auto& c : o.columns) c.values.assign(2000, nan); }},
        Mutation{"GoldenWithoutColumns", Verdict::missing, [](auto& g, auto&) { g.columns.clear(); }},
        Mutation{"BothWithoutColumns", Verdict::missing, [](auto& g, auto& o) { g.columns.clear(); o.columns.clear(); }},
        Mutation{"BothWithoutRows", Verdict::missing, [](auto& g, auto& o) { for (auto* s : {&g, &o}) for (auto& c : s->columns) c.values.clear(); }},
        Mutation{"RenamedColumn", Verdict::invalid, [](auto&, auto& o) { o.columns[6].name = "force_z"; }},
        Mutation{"RenamedInBoth", Verdict::invalid, [](auto& g, auto& o) { g.columns[6].name = o.columns[6].name = "force_z"; }},
        Mutation{"ColumnMissingInResult", Verdict::missing, [](auto&, auto& o) { o.columns.erase(o.columns.begin() + 6); }},
        Mutation{"ColumnMissingInGolden", Verdict::missing, [](auto& g, auto&) { g.columns.erase(g.columns.begin() + 6); }},
        Mutation{"ExtraColumn", Verdict::missing, [](auto&, auto& o) { o.columns.push_back({"tx", std::vector<double>(2000, 0.0)}); }},
        Mutation{"ColumnTwice", Verdict::invalid, [](auto&, auto& o) { o.columns.push_back(o.columns[4]); }},
        Mutation{"OneRowLess", Verdict::invalid, [](auto&, auto& o) { for (auto& c : o.columns) c.values.pop_back(); }},
        Mutation{"OneRowMore", Verdict::invalid, [](auto&, auto& o) { for (auto& c : o.columns) c.values.push_back(c.values.back()); }},
        Mutation{"OneColumnShorter", Verdict::invalid, [](auto&, auto& o) { column(o, "fz").pop_back(); }},
        Mutation{"SignFlip", Verdict::worse, [](auto&, auto& o) { for (auto& v : column(o, "fz")) v = -v; }},
        Mutation{"SwappedAxes", Verdict::worse, [](auto&, auto& o) { std::swap(column(o, "fx"), column(o, "fz")); }},
        Mutation{"OnePercent", Verdict::worse, [](auto&, auto& o) { for (auto& v : column(o, "fz")) v *= 1.01; }},
        Mutation{"MilliUnitTakenAsUnit", Verdict::worse, [](auto&, auto& o) { for (auto& v : column(o, "fz")) v *= 1e3; }},
        Mutation{"OneSample", Verdict::worse, [](auto&, auto& o) { column(o, "fz")[1234] += 1e-3 * std::max(1e-3, column(o, "fz")[300]); }},
        Mutation{"ZeroReferenceUnderRelative", Verdict::worse, [](auto& g, auto& o) { column(o, "fy")[0] = 1e-4 * *std::ranges::max_element(column(g, "fz")); }},
        Mutation{"UlpsThatATruncatedCountLoses", Verdict::worse, [](auto&, auto& o) { auto& v = column(o, "fz")[300]; v = std::bit_cast<double>(std::bit_cast<std::uint64_t>(v) + (std::uint64_t{1} << 40U)); }},
        Mutation{"TimesNeverAlign", Verdict::worse, [](auto&, auto& o) { for (auto& time : column(o, "t")) time += 0.0005; }},
        Mutation{"TimeInMillisecondsTakenAsSeconds", Verdict::worse, [](auto&, auto& o) { for (auto& time : column(o, "t")) time *= 1e3; }},
        Mutation{"RowsShiftedByOne", Verdict::worse, [](auto&, auto& o) { auto& f = column(o, "fz"); std::rotate(f.begin(), f.begin() + 1, f.end()); }},
        Mutation{"RowsInAnotherOrder", Verdict::worse, [](auto&, auto& o) { for (auto& c : o.columns) std::ranges::reverse(c.values); }},
        Mutation{"ConstantOffsetPosition", Verdict::worse, [](auto&, auto& o) { for (auto& v : column(o, "px")) v += 1e-3 * *std::ranges::max_element(column(o, "px")); }},
        Mutation{"ContactLostForOneSample", Verdict::worse, [](auto&, auto& o) { column(o, "contact")[300] = 0.0; }},
        Mutation{"ContactNeither0Nor1", Verdict::worse, [](auto&, auto& o) { column(o, "contact")[300] = 2.0; }},
        Mutation{"EveryForceZero", Verdict::worse, [](auto&, auto& o) { for (const char* f : {"fx", "fy", "fz"}) column(o, f).assign(2000, 0.0); }}),
    [](const auto& planted) { return std::string(planted.param.name); });

TEST(Compare, SixtyThousandRowsAgainstOneLessIsInvalid) {
  const auto golden = strokes(60000);
  auto obtained = golden;
  for (auto& c : obtained.columns) c.values.resize(59999);
  const auto result = compare(golden, obtained, default_tolerance());
  EXPECT_EQ(result.verdict, Verdict::invalid);
  EXPECT_THAT(to_table(result), testing::HasSubstr("60000"));
}

// The per-sample bound is sharp: just inside passes, just outside fails, on random samples at log-uniform scales.
TEST(Compare, BoundIsSharpOnBothSides) {
  Random random(20240607);
  for (int trial = 0; trial < 200; ++trial) {
    const double scale = random.log_uniform(1e-6, 1e6);
    GroupTolerance limits{.atol = scale * random.log_uniform(1e-9, 1e-1),
                          .rtol = random.log_uniform(1e-9, 1e-1),
                          .rpeak = random.log_uniform(1e-9, 1e-1)};
    TrajectoryColumns golden{"golden", {{"t", {0.0, 1.0, 2.0}}, {"fx", {}}}};
    for (int i = 0; i < 3; ++i) golden.columns[1].values.push_back(scale * random.uniform(-1.0, 1.0));
    const auto row = random.below(3);
    double peak = 0.0;
    for (const double f : golden.columns[1].values) peak = std::max(peak, std::abs(f));
    const double bound = limits.atol + limits.rtol * std::abs(golden.columns[1].values[row]) + limits.rpeak * peak;
    auto tolerance = default_tolerance();
    tolerance.groups["force"] = limits;
    for (const double factor : {-1.001, -0.999, 0.999, 1.001}) {
      auto obtained = golden;
      obtained.columns[1].values[row] += factor * bound;
      EXPECT_EQ(verdict_of(golden, obtained, tolerance), std::abs(factor) < 1.0 ? Verdict::equal : Verdict::worse)
          << "trial " << trial;
    }
  }
}

TEST(Compare, AtMostNSamplesBeyond) {
  const auto golden = strokes(1000);
  auto obtained = golden;
  for (const std::size_t row : {100U, 200U, 700U}) column(obtained, "fz")[row] += 0.01;
  auto tolerance = default_tolerance();
  tolerance.groups["force"].beyond = 3;
  EXPECT_EQ(verdict_of(golden, obtained, tolerance), Verdict::equal);
  tolerance.groups["force"].beyond = 2;
  const auto result = compare(golden, obtained, tolerance);
  EXPECT_EQ(result.verdict, Verdict::worse);
  EXPECT_EQ(result.find("force")->beyond, 3U);
  EXPECT_GT(result.tolerance_used(), 1.0);
}

TEST(Compare, GatesOnTheWholeRunStandBesideTheSampleBound) {
  const auto golden = strokes(1000);
  auto obtained = golden;
  for (auto& f : column(obtained, "fy")) f += 0.01;
  auto tolerance = default_tolerance();
  tolerance.groups["force"] = {.atol = 0.02, .rms = 0.011, .p99 = 0.011, .max = 0.011};
  EXPECT_EQ(verdict_of(golden, obtained, tolerance), Verdict::equal);
  for (auto gate : {&GroupTolerance::rms, &GroupTolerance::p99, &GroupTolerance::max}) {
    auto tight = tolerance;
    tight.groups["force"].*gate = 0.009;
    EXPECT_EQ(verdict_of(golden, obtained, tight), Verdict::worse);
  }
  const auto result = compare(golden, obtained, tolerance);
  EXPECT_NEAR(result.find("force")->rms, 0.01, 1e-12);
  EXPECT_NEAR(result.find("force")->axis_rms[1], 0.01, 1e-12);
  EXPECT_EQ(result.find("force")->axis_rms[0], 0.0);
}

TEST(Compare, DirectionIsGatedAboveTheFloorOnly) {
  TrajectoryColumns golden{"golden", {{"t", {0.0, 1.0}}, {"fx", {0.0, 0.0}}, {"fy", {0.0, 0.0}}, {"fz", {1.0, 0.01}}}};
  auto tolerance = default_tolerance();
  tolerance.groups["force"] = {.atol = 0.2, .direction_rad = 0.1, .direction_floor = 0.05};
  auto obtained = golden;
  column(obtained, "fx")[1] = 0.01;  // 45 degrees, below the floor
  EXPECT_EQ(verdict_of(golden, obtained, tolerance), Verdict::equal);
  column(obtained, "fx")[0] = 0.15;  // within atol, 0.149 rad
  EXPECT_EQ(verdict_of(golden, obtained, tolerance), Verdict::worse);
  tolerance.groups["force"].direction_rad = 0.15;
  EXPECT_EQ(verdict_of(golden, obtained, tolerance), Verdict::equal);
}

TEST(Compare, OrientationIsARotationNotFourNumbers) {
  TrajectoryColumns golden{"golden", {{"t", {0.0}}, {"qw", {1.0}}, {"qx", {0.0}}, {"qy", {0.0}}, {"qz", {0.0}}}};
  auto obtained = golden;
  column(obtained, "qw")[0] = -1.0;
  EXPECT_EQ(verdict_of(golden, obtained), Verdict::equal);
  column(obtained, "qw")[0] = std::cos(5e-4);
  column(obtained, "qx")[0] = std::sin(5e-4);
  const auto result = compare(golden, obtained, default_tolerance());
  EXPECT_EQ(result.verdict, Verdict::worse);
  EXPECT_NEAR(result.find("orientation")->max, 1e-3, 1e-9);
}

TEST(Compare, MetricsAreNamedAndFinite) {
  const auto golden = strokes(500);
  auto obtained = golden;
  column(obtained, "contact")[0] = 1.0;
  for (const auto& [name, value] : metrics_of(compare(golden, obtained, default_tolerance())))
    EXPECT_TRUE(std::isfinite(value)) << name;
  const auto document = to_json(compare(golden, golden, default_tolerance()));
  EXPECT_EQ(document["verdict"], "equal");
  EXPECT_EQ(document["metrics"]["force_rms_N"], 0.0);
  EXPECT_EQ(document["metrics"]["contact_shift_s"], 0.0);
}

}  // namespace
}  // namespace touchstone::golden
