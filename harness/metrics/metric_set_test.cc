#include <set>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/metrics/catalogue.h"

namespace touchstone::metrics {
namespace {

MetricSample random_sample(Random& random, int i) {
  MetricSample sample;
  sample.t_s = 0.001 * i;
  sample.f_measured_W_N = random.direction();
  sample.f_rendered_W_N = random.direction();
  sample.out_W_m = 0.01 * random.direction();
  sample.contact_W_m = 0.01 * random.direction();
  sample.cost_us = random.uniform(0.1, 1.0);
  return sample;
}

TEST(MetricSet, NamesAreUniqueAndEveryResultHasUnitAndMeaning) {
  std::set<std::string> names;
  for (const MetricResult& result : MetricSet({}, {}, {}).results()) {
    EXPECT_TRUE(names.insert(result.name).second) << result.name;
    EXPECT_FALSE(result.unit.empty()) << result.name;
    EXPECT_FALSE(result.meaning.empty()) << result.name;
    EXPECT_EQ(result.status, MetricStatus::missing) << result.name << ": without samples there is no number";
  }
}

TEST(MetricSet, ChoosesByEntryOrByResult) {
  MetricSet set({"rms_force_error", "step-cost"}, {}, {});
  const auto results = set.results();
  EXPECT_EQ(results.size(), find_metric("force-error").results.size() + find_metric("step-cost").results.size());
  EXPECT_THROW(MetricSet({"rms_farce_error"}, {}, {}), UsageError);
}

TEST(MetricSet, AnAbsentInputIsMissingWithItsReason) {
  MetricInputs inputs;
  inputs.force = false;
  MetricSet set({}, inputs, {});
  Random random(1);
  set.add(random_sample(random, 0));
  const auto results = set.results();
  EXPECT_EQ(find_result(results, "rms_force_error").status, MetricStatus::missing);
  EXPECT_EQ(find_result(results, "rms_force_error").note, "the recording has no force");
  EXPECT_EQ(find_result(results, "rms_position_error").status, MetricStatus::ok);
}

// Whatever member is not a number, every metric that reads it has no number, and none of the others minds.
TEST(MetricSet, NotANumberNeverTurnsIntoANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<const char*, std::function<void(MetricSample&)>>> spoilers{
      {"force", [&](MetricSample& s) { s.f_rendered_W_N[1] = nan; }},
      {"force", [&](MetricSample& s) { s.f_measured_W_N[0] = -std::numeric_limits<double>::infinity(); }},
      {"position", [&](MetricSample& s) { s.contact_W_m[2] = nan; }},
      {"cost", [&](MetricSample& s) { s.cost_us = nan; }}};
  for (const auto& [what, spoil] : spoilers) {
    Random random(2);
    MetricSet set({}, {}, {});
    for (int i = 0; i < 100; ++i) {
      MetricSample sample = random_sample(random, i);
      if (i == 42) spoil(sample);
      set.add(sample);
    }
    for (const MetricResult& result : set.results()) {
      const MetricEntry& entry = find_metric(result.name);
      const bool spoilt = (entry.needs_force && what == std::string("force")) ||
                          (entry.needs_position && what == std::string("position")) ||
                          (entry.needs_cost && what == std::string("cost"));
      EXPECT_EQ(result.status == MetricStatus::invalid, spoilt) << what << ' ' << result.name << ' ' << result.note;
      if (spoilt) {
        EXPECT_TRUE(std::isnan(result.value)) << result.name;
        EXPECT_NE(result.note.find("t = 0.042"), std::string::npos) << result.note;
      }
    }
  }
}

// Bounded memory: what a result carries does not grow with the recording.
TEST(MetricSet, ResultsDoNotGrowWithTheRecording) {
  Random random(4);
  MetricSet set({}, {}, {});
  for (int i = 0; i < 200'000; ++i) set.add(random_sample(random, i));
  for (const MetricResult& result : set.results()) {
    EXPECT_LE(result.series ? result.series->value.size() : 0, SeriesRecorder::default_points) << result.name;
    EXPECT_LE(result.histogram ? result.histogram->counts.size() : 0, HistogramRecorder::bins) << result.name;
  }
  EXPECT_LE(set.force_episodes().size(), EpisodeFinder::kept);
}

}  // namespace
}  // namespace touchstone::metrics
